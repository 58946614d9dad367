#include "planner/results/strict_json.h"

#include <fmt/format.h>

#include <optional>
#include <set>
#include <vector>

#include "common/bounded_json.h"
#include "common/read_file.h"
#include "common/strict_yaml.h"

namespace fjr {

using Json = nlohmann::ordered_json;

Json parse_json(const std::string& text, const std::string& source) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open, from the outside
  std::optional<std::string> twice;
  bool too_deep = false;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    too_deep = too_deep || is_too_deep(depth, event);
    if (too_deep) return false;
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second && !twice) {
      twice = value.get<std::string>();
    }
    return true;
  };
  Json json = Json::parse(text, watch, false);
  if (too_deep) throw InputError(source, "", "is damaged: it is nested too deeply");
  if (json.is_discarded()) throw InputError(source, "", "is damaged: it is not JSON");
  if (twice) throw InputError(source, "", fmt::format("has the key {} twice in one object", shown(*twice)));
  return json;
}

Json load_plan_json(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "plan.json";
  std::optional<std::string> text;
  try {
    text = read_file(file);
  } catch (const std::runtime_error& error) {
    throw InputError(file.string(), "", error.what());
  }
  if (!text)
    throw InputError(file.string(), "", "cannot be read: this is no folder of a plan (fjr plan REQUEST --out DIR)");
  return parse_json(*text, file.string());
}

}  // namespace fjr
