// Parses JSON and CBOR from outside with a bounded depth. The library reads, copies and writes values recursively, so
// that deeply nested ones would overflow the stack. Values nested more deeply than any that this program writes are
// refused.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace fjr {

inline constexpr std::size_t kDeepestJson = 64;  // objects and arrays within each other; plan.json has 8

// Parser callback: returns whether the object or array that begins within `depth` others is nested too deeply.
inline bool is_too_deep(int depth, nlohmann::json::parse_event_t event) {
  using Kind = nlohmann::json::parse_event_t;
  return (event == Kind::object_start || event == Kind::array_start) && depth >= static_cast<int>(kDeepestJson);
}

// Returns the value of a JSON text. It is discarded (is_discarded()) if the text is not JSON or nested too deeply.
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

// Walks through CBOR without storing it, and stops if it is nested too deeply, since the CBOR reader has no callback.
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

// Returns whether a string of unknown length begins within another one. CBOR (RFC 8949, 3.2.3) does not allow that, but
// the library reads such strings recursively, so that many would overflow the stack. Heads of items follow each other
// in the bytes however deeply the items are nested; what is cut short or no CBOR is left to the library.
inline bool nests_strings(std::string_view bytes) {
  constexpr unsigned kUnknownLength = 31, kBytes = 2, kText = 3, kSimple = 7;
  bool in_string = false;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto head = static_cast<unsigned char>(bytes[at++]);
    const unsigned major = head >> 5U, info = head & 31U;
    if (info == kUnknownLength) {
      const bool string = major == kBytes || major == kText;
      if (string && in_string) return true;
      if (string || major == kSimple) in_string = string;  // 7 with 31 ends what was begun last
      continue;
    }
    std::uint64_t argument = info;
    if (info >= 24 && info <= 27) {
      const std::size_t count = std::size_t{1} << (info - 24);
      if (count > bytes.size() - at) return false;
      argument = 0;
      for (std::size_t i = 0; i < count; ++i) argument = argument << 8U | static_cast<unsigned char>(bytes[at++]);
    }
    if (major != kBytes && major != kText) continue;
    if (argument > bytes.size() - at) return false;
    at += static_cast<std::size_t>(argument);
  }
  return false;
}

// Returns the value of a CBOR item. Throws std::invalid_argument if it is not CBOR or nested too deeply.
template <class Json>
Json json_from_cbor(std::string_view bytes) {
  if (nests_strings(bytes)) throw std::invalid_argument("a string of unknown length within another one");
  DepthCheck<Json> check;
  if (Json::sax_parse(bytes, &check, Json::input_format_t::cbor)) {
    Json value = Json::from_cbor(bytes, true, false);
    if (!value.is_discarded()) return value;
  }
  throw std::invalid_argument(check.too_deep() ? "nested too deeply" : "cut short, or no CBOR at all");
}

}  // namespace fjr
