// Only this file uses libmatio.
#include <fmt/format.h>
#include <matio.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "common/atomic_file.h"
#include "planner/problem/quantities.h"
#include "planner/results/export/formats.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct Free {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, Close>;
using Variable = std::unique_ptr<matvar_t, Free>;

constexpr std::uintmax_t kHeaderBytes = 128;  // of a level 5 file, in front of its elements

// A temporary file beside the target, which is removed unless it was renamed.
class Beside {
 public:
  explicit Beside(const fs::path& file) : path_(temporary_beside(file)) {}
  ~Beside() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

template <class Made>
Made checked(Made made, const std::string& what) {
  if (!made) throw std::runtime_error(what + ": cannot be written as a MATLAB file");
  return made;
}

// MATLAB has no vectors, only matrices; data is copied.
Variable matrix(const char* name, std::vector<double> values, std::size_t rows, std::size_t columns) {
  std::array<std::size_t, 2> size{rows, columns};
  return checked(Variable(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0)), name);
}

Variable text(const char* name, std::string value) {
  std::array<std::size_t, 2> size{1, value.size()};
  return checked(Variable(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size.data(), value.data(), 0)), name);
}

// Returns the limits in plan.json, with the middle from which positions of the links are measured if it is not zero.
nlohmann::ordered_json limits_with_middle(const PlanRecord& plan) {
  nlohmann::ordered_json limits = plan.plan.at("resolved_request").at("limits");
  const Joints<double>& middle = plan.robot.limits.link_middle;
  if (middle != Joints<double>{}) limits["link_middle"] = middle;
  return limits;
}

// Returns the struct `limits` with one field per limit, which has one number per joint.
Variable limits_of(const nlohmann::ordered_json& limits) {
  std::vector<const char*> names;
  for (const auto& [name, value] : limits.items()) names.push_back(name.c_str());
  std::array<std::size_t, 2> one{1, 1};
  Variable all =
      checked(Variable(Mat_VarCreateStruct("limits", 2, one.data(), names.data(), static_cast<unsigned>(names.size()))),
              "limits");
  for (const auto& [name, value] : limits.items()) {
    std::vector<double> numbers;
    for (const auto& number : value) numbers.push_back(number.is_null() ? kNoLimit : number.get<double>());
    Mat_VarSetStructFieldByName(all.get(), name.c_str(), 0, matrix(name.c_str(), numbers, 1, numbers.size()).release());
  }
  return all;
}

// Returns the status of the rows: learnt ones are not certified, whatever their plan was.
std::string status_of(const PlanRecord& plan) {
  if (plan.trajectory) {
    const auto told = plan.trajectory->metadata.find("status");
    if (told != plan.trajectory->metadata.end()) return told->second;
  }
  return plan.plan.at("status").get<std::string>();
}

// Calls `use` with each variable of the file, in their order. Only one is in memory at a time, because a long plan has
// columns of 16 MB.
template <class Use>
void each_variable(const Exported& exported, const ExportTable& table, Use&& use) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    use(matrix(table.names[i].c_str(), table.values[i], table.values[i].size(), 1));
  }
  if (exported.plan == nullptr) return;
  const auto& plan = exported.plan->plan;
  use(limits_of(limits_with_middle(*exported.plan)));
  for (const char* key : {"request", "request_hash", "robot_hash"}) use(text(key, plan.at(key).get<std::string>()));
  use(text("status", status_of(*exported.plan)));
  use(matrix("tick_s", {exported.ticked->tick}, 1, 1));
}

std::runtime_error cannot_write(const fs::path& file, const std::string& reason) {
  return std::runtime_error(fmt::format("cannot write {}: {}", file.string(), reason));
}

bool same(matvar_t* wanted, matvar_t* found) {
  if (wanted == nullptr || found == nullptr) return wanted == found;
  if (wanted->class_type != found->class_type || wanted->nbytes != found->nbytes) return false;
  if (wanted->class_type != MAT_C_STRUCT) {
    return wanted->nbytes == 0 || std::memcmp(wanted->data, found->data, wanted->nbytes) == 0;
  }
  const unsigned fields = Mat_VarGetNumberOfFields(wanted);
  if (fields != Mat_VarGetNumberOfFields(found)) return false;
  for (unsigned i = 0; i < fields; ++i) {
    if (!same(Mat_VarGetStructFieldByIndex(wanted, i, 0), Mat_VarGetStructFieldByIndex(found, i, 0))) return false;
  }
  return true;
}

// Returns whether the last element ends where the file does. matio does not tell when a value that it reads is cut
// short: the rest of it is then whatever was in memory before, which may be the very value that was to be written.
bool ends_with_an_element(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return false;
  std::ifstream in(file, std::ios::binary);
  std::uintmax_t at = kHeaderBytes;
  while (at < size) {
    std::array<std::uint32_t, 2> tag{};  // type and number of bytes that follow
    in.seekg(static_cast<std::streamoff>(at));
    if (!in.read(reinterpret_cast<char*>(tag.data()), sizeof(tag))) return false;
    at += sizeof(tag) + tag[1];
  }
  return at == size;
}

// Returns whether all that was to be written is in the file.
bool is_whole(const fs::path& file, const Exported& exported, const ExportTable& table) {
  if (!ends_with_an_element(file)) return false;
  const MatFile mat(Mat_Open(file.c_str(), MAT_ACC_RDONLY));
  if (!mat) return false;
  bool whole = true;
  each_variable(exported, table, [&](const Variable& wanted) {
    const Variable found(whole ? Mat_VarReadNext(mat.get()) : nullptr);
    whole = found && found->name != nullptr && std::strcmp(wanted->name, found->name) == 0 &&
            same(wanted.get(), found.get());
  });
  return whole;
}

}  // namespace

void write_mat(const Exported& exported, const ExportTable& table, const fs::path& file) {
  const Beside part(file);
  const std::string header = "MATLAB 5.0 MAT-file, written by fjr " FJR_VERSION;
  MatFile mat = checked(MatFile(Mat_CreateVer(part.path().c_str(), header.c_str(), MAT_FT_MAT5)), file.string());
  bool written = true;
  each_variable(exported, table, [&](const Variable& variable) {
    written = written && Mat_VarWrite(mat.get(), variable.get(), MAT_COMPRESSION_NONE) == 0;
  });
  // matio does not check what it writes, and a full disk may have taken a part of it, so it is read back.
  const bool closed = Mat_Close(mat.release()) == 0;
  if (!written || !closed || !is_whole(part.path(), exported, table)) {
    throw cannot_write(file, "not all of it arrived in the file system, which may be full");
  }
  std::error_code error;
  fs::rename(part.path(), file, error);
  if (error) throw cannot_write(file, error.message());
}

}  // namespace fjr
