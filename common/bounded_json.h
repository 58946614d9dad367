// JSON and CBOR that somebody else may have written: what is nested more deeply than anything that this program writes
// is refused, because the library reads, copies and writes such values by functions that call themselves, until the
// stack ends.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace fjr {

inline constexpr std::size_t kDeepestJson = 64;  // objects and arrays within each other; plan.json has 8

// Whether what begins here in a text, within `depth` objects and arrays, is nested too deeply.
inline bool is_too_deep(int depth, nlohmann::json::parse_event_t event) {
  using Kind = nlohmann::json::parse_event_t;
  return (event == Kind::object_start || event == Kind::array_start) && depth >= static_cast<int>(kDeepestJson);
}

// The value of a text. Discarded (is_discarded()) where it is no JSON, or nested too deeply.
template <class Json>
Json json_from_text(std::string_view text) {
  bool too_deep = false;
  const auto watch = [&](int depth, typename Json::parse_event_t event, Json&) {
    too_deep = too_deep || is_too_deep(depth, event);
    return !too_deep;
  };
  Json value = Json::parse(text, watch, false);
  return too_deep ? Json(Json::value_t::discarded) : value;
}

// Follows CBOR, whose reader takes no callback, without keeping it, and stops it at what is nested too deeply.
template <class Json>
class DepthCheck final : public nlohmann::json_sax<Json> {
 public:
  bool too_deep() const { return depth_ > kDeepestJson; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(typename Json::number_integer_t) override { return true; }
  bool number_unsigned(typename Json::number_unsigned_t) override { return true; }
  bool number_float(typename Json::number_float_t, const typename Json::string_t&) override { return true; }
  bool string(typename Json::string_t&) override { return true; }
  bool binary(typename Json::binary_t&) override { return true; }
  bool key(typename Json::string_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kDeepestJson; }
  bool start_array(std::size_t) override { return ++depth_ <= kDeepestJson; }
  bool end_object() override { return --depth_, true; }
  bool end_array() override { return --depth_, true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  std::size_t depth_ = 0;
};

// The value of a CBOR item. Throws std::invalid_argument where it is none, or nested too deeply.
template <class Json>
Json json_from_cbor(std::string_view bytes) {
  DepthCheck<Json> check;
  if (Json::sax_parse(bytes, &check, Json::input_format_t::cbor)) {
    Json value = Json::from_cbor(bytes, true, false);
    if (!value.is_discarded()) return value;
  }
  throw std::invalid_argument(check.too_deep() ? "nested too deeply" : "cut short, or no CBOR at all");
}

}  // namespace fjr
