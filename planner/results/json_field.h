// Strict reading of JSON: errors about missing values or wrong types name the path of the value.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "model/parameters.h"

namespace fjr {

// A JSON value together with its path. The document must outlive it. All reading functions throw InputError.
class JsonField {
 public:
  using Json = nlohmann::ordered_json;

  JsonField(const Json& json, const std::string& source, std::string path = "")
      : json_(&json), source_(source), path_(std::move(path)) {}

  const Json& json() const { return *json_; }
  const std::string& source() const { return source_; }
  bool is_null() const { return json_->is_null(); }

  JsonField at(const std::string& key) const {
    if (auto found = find(key)) return *found;
    throw InputError(source_, below(key), "missing");
  }
  std::optional<JsonField> find(const std::string& key) const {
    if (!json_->is_object()) fail("must be an object");
    const auto found = json_->find(key);
    if (found == json_->end()) return std::nullopt;
    return JsonField(*found, source_, below(key));
  }
  std::vector<JsonField> items() const {
    if (!json_->is_array()) fail("must be a list");
    std::vector<JsonField> fields;
    for (std::size_t i = 0; i < json_->size(); ++i) {
      fields.emplace_back((*json_)[i], source_, path_ + "[" + std::to_string(i) + "]");
    }
    return fields;
  }

  // Returns NaN for null, which plan.json contains for numbers that are not finite or do not exist.
  double number() const {
    if (is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (!json_->is_number()) fail("must be a number or null");
    return json_->get<double>();
  }
  Joints<double> pair() const {
    const std::vector<JsonField> both = items();
    if (both.size() != kJoints) fail("must be a list of two numbers");
    return {both[0].number(), both[1].number()};
  }
  std::vector<double> numbers() const {
    std::vector<double> values;
    for (const JsonField& item : items()) values.push_back(item.number());
    return values;
  }
  // Returns an empty text for null.
  std::string text() const {
    if (is_null()) return "";
    if (!json_->is_string()) fail("must be text or null");
    return json_->get<std::string>();
  }
  bool flag() const {
    if (!json_->is_boolean()) fail("must be true or false");
    return json_->get<bool>();
  }

  [[noreturn]] void fail(const std::string& problem) const { throw InputError(source_, path_, problem); }

 private:
  std::string below(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  const Json* json_;
  std::string source_, path_;
};

}  // namespace fjr
