// fjr's requests and replies for Fast DDS, written after the files in idl/ by hand with Fast CDR: nothing here knows
// what Cyclone DDS makes of them.
#pragma once

#include <fastcdr/Cdr.h>

#include <array>
#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

namespace fast_dds {

using Bytes = std::array<std::uint8_t, 16>;
using Pair = std::array<double, 2>;

struct Request {
  Bytes client{};
  std::uint64_t number = 0;
  Pair start{}, goal{};
  std::vector<std::uint8_t> garbage;  // sent in place of all that unless empty

  void write(eprosima::fastcdr::Cdr& cdr) const {
    const Pair none{};
    const std::string text;
    const std::uint8_t octet = 0;
    const std::uint32_t no_items = 0;
    cdr << client << number << octet;                     // id, action: plan
    cdr << Bytes{} << std::uint64_t{0};                   // trajectory_id
    cdr << text << text << std::string("fast_dds.yaml");  // robot_id, robot_hash, name
    cdr << std::int32_t{0} << 0.0;                        // priority, budget
    cdr << true << start;                                 // start
    for (int i = 0; i < 3; ++i) cdr << false << none;     //   dq, theta, dtheta
    cdr << octet << goal << false << false;               // goal: joints
    for (int i = 0; i < 3; ++i) cdr << false << none;     //   dq, theta, dtheta
    cdr << none << octet << false << none;                //   tip, elbow, tip_velocity
    cdr << false << 0.0 << false << 0.0;                  // duration
    cdr << std::uint8_t{1};                               // objective: fastest
    for (int i = 0; i < 6; ++i) cdr << 0.0;               //   weights
    cdr << no_items << no_items;                          // via, obstacles
    cdr << octet;                                         // tip
    for (int i = 0; i < 5; ++i) cdr << none;              //   lower, upper, from, to, center
    cdr << 0.0;                                           //   tolerance
    for (int i = 0; i < 5; ++i) cdr << false << none;     // limits
    cdr << false << 0.0;                                  //   tip_speed
    cdr << false << 0.0 << 0.0;                           // payload
    cdr << false << 0.0 << false << std::uint64_t{0};     // sample_period, seed
  }
};

struct Reply {
  Bytes client{};
  std::uint64_t number = 0;
  std::uint8_t state = 0, reason = 0;
  std::string field, sentence, robot_id, robot_hash, request_hash, version;
  double solve_time = 0, wait_time = 0;
  std::vector<std::uint8_t> plan_json;
  std::vector<std::array<double, 11>> rows;

  void read(eprosima::fastcdr::Cdr& cdr) {
    cdr >> client >> number >> state >> reason >> field >> sentence >> robot_id >> robot_hash >> request_hash >>
        version;
    cdr >> solve_time >> wait_time >> plan_json;
    std::uint32_t count = 0;
    cdr >> count;
    rows.assign(count, {});
    for (auto& row : rows) cdr >> row;
  }
};

// The part of a type that is the same for all: T is written or read as a whole.
template <class T>
class Type : public eprosima::fastdds::dds::TopicDataType {
 public:
  Type(const char* name, std::uint32_t usual_size) {
    setName(name);
    m_typeSize = usual_size;
    m_isGetKeyDefined = false;
  }

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    if constexpr (requires(T t, eprosima::fastcdr::Cdr & cdr) { t.write(cdr); }) {
      const T& sample = *static_cast<const T*>(data);
      eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
      eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
      payload->encapsulation = CDR_LE;
      cdr.serialize_encapsulation();
      if (sample.garbage.empty()) {
        sample.write(cdr);
      } else {
        cdr.serializeArray(sample.garbage.data(), sample.garbage.size());
      }
      payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
      return true;
    }
    return false;
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    if constexpr (requires(T t, eprosima::fastcdr::Cdr & cdr) { t.read(cdr); }) {
      eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
      eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::Cdr::DDS_CDR);
      cdr.read_encapsulation();
      static_cast<T*>(data)->read(cdr);
      return true;
    }
    return false;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [size = m_typeSize] { return size; };
  }
  void* createData() override { return new T; }
  void deleteData(void* data) override { delete static_cast<T*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

}  // namespace fast_dds
