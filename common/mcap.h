// A writer of MCAP, the container format of Foxglove, PlotJuggler and rosbag2: timed messages on topics, each with a
// schema. It follows https://mcap.dev/spec, with uncompressed chunks, their indexes, and a summary at the end. Debian
// 12 has no library for it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fjr {

class McapWriter {
 public:
  // profile: "ros2", or "" for none. library: name of the writing program.
  McapWriter(std::string_view profile, std::string_view library);

  // A topic whose messages are encoded ("json", "cdr") as the schema says. Returns its number.
  std::uint16_t add_topic(std::string_view topic, std::string_view message_encoding, std::string_view schema_name,
                          std::string_view schema_encoding, std::string_view schema);

  // time [ns].
  void add(std::uint16_t topic, std::uint64_t time, std::string message);

  // The whole file; messages in the order of time.
  std::string finish();

 private:
  struct Message {
    std::uint16_t topic;
    std::uint64_t time;
    std::string data;
  };

  std::string header_, schemas_, channels_;
  std::uint16_t topics_ = 0;
  std::vector<Message> messages_;
};

}  // namespace fjr
