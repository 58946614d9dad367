#include "planner/batch/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/input_error.h"
#include "common/read_file.h"
#include "common/sha256.h"
#include "common/strict_yaml.h"
#include "planner/batch/grid.h"
#include "planner/batch/name_order.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kManifestTables = R"(
  CREATE TABLE IF NOT EXISTS settings (key TEXT PRIMARY KEY, value TEXT);
  CREATE TABLE IF NOT EXISTS requests (
    name TEXT PRIMARY KEY, chunk INTEGER, source TEXT, yaml TEXT, axes TEXT, digest TEXT);
  CREATE INDEX IF NOT EXISTS requests_by_chunk ON requests (chunk);
)";

fs::path manifest_file(const fs::path& folder) { return folder / "manifest.sqlite"; }

// Throws InputError for a folder with another batch, or without one.
fs::path existing(const fs::path& folder) {
  const fs::path file = manifest_file(folder);
  if (fs::exists(file)) return file;
  throw InputError(folder.string(), "",
                   "holds no manifest.sqlite: it is no packed batch (fjr batch prepare REQUESTS... --out DIR)");
}

// Checks a manifest that somebody may have edited. Names are used as names of folders, and must not lead out of the
// batch's; chunks must be numbered without gaps, because they are counted, and requests of others would be left out.
// Throws InputError.
void check_requests(const Database& database, const fs::path& file) {
  Statement faults = database.query(
      "SELECT name FROM requests WHERE typeof(name) <> 'text' OR name IN ('', '.', '..') OR instr(name, '/') > 0");
  if (faults.step()) {
    throw InputError(file.string(), "requests.name",
                     fmt::format("{} is no name of a folder: the manifest was edited", shown(faults.text(0))));
  }
  Statement chunks = database.query(
      "SELECT count(DISTINCT chunk), ifnull(min(chunk), 1), ifnull(max(chunk), 0), "
      "total(typeof(chunk) <> 'integer') FROM requests");
  chunks.step();
  const auto count = chunks.integer(0);
  if (chunks.real(3) == 0 && chunks.integer(1) == 1 && chunks.integer(2) == count) return;
  throw InputError(file.string(), "requests.chunk",
                   fmt::format("holds other values than the numbers from 1 to {}: the manifest was edited", count));
}

// Hashes of robot files, each of which is read only once.
class Robots {
 public:
  // Returns the hash of the robot file that a request names or gets by default. If the file cannot be read, it is the
  // hash of an empty text, and the error is reported when the request is planned.
  const std::string& hash_for(const YamlNode& request, const fs::path& folder) {
    const auto robot = request.find("robot");
    const auto [found, fresh] = hashes_.try_emplace(robot ? folder / robot->text() : default_robot_file());
    if (fresh) found->second = sha256_hex(contents(found->first));
    return found->second;
  }

 private:
  static std::string contents(const fs::path& file) {
    try {
      return read_file(file).value_or("");
    } catch (const std::runtime_error&) {
      return "";
    }
  }

  std::map<fs::path, std::string> hashes_;
};

struct Text {
  std::string source, yaml, axes, digest;
};

// Returns the request in a form that is independent of machine and folder. Text that is not YAML stays as it is, and is
// refused when it is planned.
Text text_of(const BatchItem& item, Robots& robots) {
  Text text;
  // A point of a grid is not in a file, so messages use its name.
  text.source = item.yaml ? item.name + ".yaml" : fs::absolute(item.request).lexically_normal().string();
  text.axes = item.axes.dump();
  const std::string given = item.yaml ? *item.yaml : read_document(item.request);
  std::string robot;
  try {
    const YamlNode request = YamlNode::parse(given, text.source);
    if (!request.is_map()) request.fail("is no request");
    const fs::path folder = fs::path(text.source).parent_path();
    text.yaml = standing_alone(request, folder);
    robot = robots.hash_for(request, folder);
  } catch (const InputError&) {
    text.yaml = given;
  }
  text.digest = sha256_hex(fmt::format("{}\n{}\n{}", FJR_VERSION, text.yaml, robot));
  return text;
}

std::vector<Text> texts_of(const std::vector<BatchItem>& items) {
  Robots robots;
  std::vector<Text> texts;
  texts.reserve(items.size());
  for (const BatchItem& item : items) texts.push_back(text_of(item, robots));
  return texts;
}

void check_options(const Database& database, const std::vector<std::string>& options) {
  Statement known = database.query("SELECT value FROM settings WHERE key = 'options'");
  const std::string words = Json(options).dump();
  if (!known.step()) return database.run("INSERT INTO settings VALUES ('options', ?)", words);
  if (known.text(0) == words) return;
  const auto shown = [](const std::string& json) {
    return fmt::format("{}", fmt::join(Json::parse(json).get<std::vector<std::string>>(), " "));
  };
  throw InputError(
      "--out", "",
      fmt::format("the batch there was begun with other options, {}: these, {}, belong into another folder",
                  shown(known.text(0)), shown(words)));
}

// Requests are dealt out to chunks in turn, as to shards, because neighbours in a grid take similar time.
void deal_out(const Database& database, const std::vector<std::string>& names, std::size_t chunk_size) {
  Statement last = database.query("SELECT ifnull(max(chunk), 0) FROM requests");
  last.step();
  const auto before = static_cast<std::size_t>(last.integer(0));
  const std::size_t chunks = (names.size() + chunk_size - 1) / chunk_size;
  Statement put = database.prepare("UPDATE requests SET chunk = ? WHERE name = ?");
  for (std::size_t i = 0; i < names.size(); ++i) {
    put.with(before + 1 + i % chunks, names[i]).step();
    put.reset();
  }
}

}  // namespace

Manifest::Manifest(fs::path folder)
    : folder_(std::move(folder)), database_(existing(folder_), Database::Access::kRead) {
  check_requests(database_, manifest_file(folder_));
}

fs::path Manifest::chunk_file(std::size_t chunk) const {
  return folder_ / "chunks" / fmt::format("{:05}.sqlite", chunk);
}

std::vector<std::string> Manifest::options() const {
  Statement known = database_.query("SELECT value FROM settings WHERE key = 'options'");
  return known.step() ? Json::parse(known.text(0)).get<std::vector<std::string>>() : std::vector<std::string>();
}

bool Manifest::asks_for(const std::string& option) const {
  const std::vector<std::string> words = options();
  return std::find(words.begin(), words.end(), option) != words.end();
}

std::size_t Manifest::chunks() const {
  Statement last = database_.query("SELECT ifnull(max(chunk), 0) FROM requests");
  last.step();
  return static_cast<std::size_t>(last.integer(0));
}

namespace {

constexpr const char* kColumns = "SELECT name, source, yaml, axes, digest, chunk FROM requests";

ManifestItem read(const Statement& row) {
  return {{row.text(0), row.text(1), row.text(2), Json::parse(row.text(3))}, row.text(4)};
}

}  // namespace

std::vector<ManifestItem> Manifest::items(std::size_t chunk) const {
  Statement rows = database_.query(fmt::format("{} WHERE chunk = ?", kColumns), chunk);
  std::vector<ManifestItem> items;
  while (rows.step()) items.push_back(read(rows));
  std::sort(items.begin(), items.end(),
            [](const ManifestItem& a, const ManifestItem& b) { return comes_before(a.item.name, b.item.name); });
  return items;
}

void Manifest::for_each(std::size_t chunk, const std::function<void(std::string, std::string)>& take) const {
  Statement rows = database_.query("SELECT name, digest FROM requests WHERE chunk = ?", chunk);
  while (rows.step()) take(rows.text(0), rows.text(1));
}

std::vector<std::string> Manifest::names() const {
  Statement rows = database_.query("SELECT name FROM requests");
  std::vector<std::string> names;
  while (rows.step()) names.push_back(rows.text(0));
  std::sort(names.begin(), names.end(), comes_before);
  return names;
}

BatchItem Manifest::item(const std::string& name, std::size_t& chunk) const {
  Statement rows = database_.query(fmt::format("{} WHERE name = ?", kColumns), name);
  if (!rows.step()) throw InputError(folder_.string(), "", fmt::format("holds no request {}", shown(name)));
  chunk = static_cast<std::size_t>(rows.integer(5));
  return read(rows).item;
}

namespace {

// Returns the names of new requests, which have no chunk yet.
std::vector<std::string> put(const Database& database, const std::vector<BatchItem>& items,
                             const std::vector<Text>& texts, Prepared& prepared) {
  Statement known = database.prepare("SELECT digest FROM requests WHERE name = ?");
  Statement change = database.prepare("UPDATE requests SET source = ?, yaml = ?, axes = ?, digest = ? WHERE name = ?");
  Statement insert = database.prepare("INSERT INTO requests (source, yaml, axes, digest, name) VALUES (?, ?, ?, ?, ?)");
  std::vector<std::string> added;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Text& text = texts[i];
    const bool there = known.with(items[i].name).step();
    const bool same = there && known.text(0) == text.digest;
    known.reset();
    ++(same ? prepared.unchanged : there ? prepared.changed : prepared.added);
    if (!there) added.push_back(items[i].name);
    if (same) continue;
    Statement& row = there ? change : insert;
    row.with(text.source, text.yaml, text.axes, text.digest, items[i].name).step();
    row.reset();
  }
  return added;
}

std::size_t count_requests(const Database& database) {
  Statement all = database.query("SELECT count(*) FROM requests");
  all.step();
  return static_cast<std::size_t>(all.integer(0));
}

}  // namespace

Prepared prepare(const fs::path& folder, const std::vector<BatchItem>& items, const std::vector<std::string>& options,
                 std::size_t chunk_size) {
  const std::vector<Text> texts = texts_of(items);
  std::error_code error;
  fs::create_directories(folder / "chunks", error);
  if (error) throw InputError("--out", "", fmt::format("cannot make folder {}: {}", folder.string(), error.message()));

  const Database database(manifest_file(folder), Database::Access::kWrite);
  Transaction transaction(database);
  database.execute(kManifestTables);
  check_requests(database, manifest_file(folder));
  check_options(database, options);
  Prepared prepared;
  const std::vector<std::string> added = put(database, items, texts, prepared);
  if (!added.empty()) deal_out(database, added, chunk_size);
  prepared.kept = count_requests(database) - items.size();
  transaction.commit();
  return prepared;
}

}  // namespace fjr
