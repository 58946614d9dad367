// Only this file uses libmatio.
#include <fmt/format.h>
#include <matio.h>

#include <array>
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

void write(mat_t* file, const Variable& variable) {
  if (Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_NONE) != 0) {
    throw std::runtime_error(std::string(variable->name) + ": cannot be written to a MATLAB file");
  }
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

}  // namespace

void write_mat(const Exported& exported, const ExportTable& table, const fs::path& file) {
  const Beside part(file);
  {
    const std::string header = "MATLAB 5.0 MAT-file, written by fjr " FJR_VERSION;
    const MatFile mat =
        checked(MatFile(Mat_CreateVer(part.path().c_str(), header.c_str(), MAT_FT_MAT5)), file.string());
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      write(mat.get(), matrix(table.names[i].c_str(), table.values[i], table.values[i].size(), 1));
    }
    if (exported.plan != nullptr) {
      const auto& plan = exported.plan->plan;
      write(mat.get(), limits_of(limits_with_middle(*exported.plan)));
      for (const char* key : {"request", "status", "request_hash", "robot_hash"}) {
        write(mat.get(), text(key, plan.at(key).get<std::string>()));
      }
      write(mat.get(), matrix("tick_s", {exported.ticked->tick}, 1, 1));
    }
  }
  std::error_code error;
  fs::rename(part.path(), file, error);
  if (error) throw std::runtime_error(fmt::format("{}: {}", file.string(), error.message()));
}

}  // namespace fjr
