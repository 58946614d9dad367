// A ROS 2 service as implemented by rmw_cyclonedds_cpp: requests on rq/<name>Request and responses on rr/<name>Reply,
// each preceded by the client's 64-bit number and a sequence number. Every client reads all responses and picks its
// own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "planner/dds/participant.h"
#include "planner/dds/reader.h"
#include "planner/dds/writer.h"

namespace fjr::dds {

// Returns the user data that the reader and the writer of a service, or those of a client, have in common:
// `serviceid=...;` or `clientid=...;` (rmw_node.cpp, rmw_init_cs).
std::string ros2_user_data(const std::string& key, const std::string& id);

struct Ros2Call {
  std::uint64_t client = 0;
  std::int64_t number = 0;
  dds_instance_handle_t writer = 0;  // that wrote the request
};

enum class CallerPresence { kReads, kMayComeToRead, kGone };

// Returns whether the client's reader of responses has been discovered; a response written before that would be lost. A
// client without an id, as of the first versions, is assumed to be there.
CallerPresence presence_of(const Ros2Call& call, dds_entity_t requests, dds_entity_t responses);

template <class Request, class Response>
class Ros2Service {
 public:
  using Write = std::function<bool(Writer<Response>&)>;

  // name: with its leading slash.
  Ros2Service(const Participant& participant, const std::string& name, const std::string& id)
      : requests_(participant, participant.handle(), service_qos(id), ("rq" + name + "Request").c_str()),
        responses_(participant, participant.handle(), service_qos(id), ("rr" + name + "Reply").c_str()) {}

  dds_entity_t arrived() const { return requests_.arrived(); }

  template <class Use>
  void take_at_most(std::size_t most, Use&& use) {
    requests_.take_at_most(most, [&](const Request& request, const dds_sample_info_t& info) {
      if (info.valid_data) use(request, Ros2Call{request.client_, request.number_, info.publication_handle});
    });
  }

  // Sends a response as soon as the client can read it; gives up after the same time as rmw_send_response.
  void respond(const Ros2Call& call, Write write) {
    if (waiting_.size() == kMostWaiting) waiting_.pop_front();
    waiting_.push_back({call, Clock::now() + kPatience, std::move(write)});
    look();
  }

  // Writes the responses that can be written; returns whether some still wait.
  bool look() {
    std::erase_if(waiting_, [this](Waiting& one) {
      const CallerPresence presence = presence_of(one.call, requests_.handle(), responses_.handle());
      if (presence == CallerPresence::kReads) (void)one.write(responses_);  // a client that misses it asks again
      return presence != CallerPresence::kMayComeToRead || Clock::now() > one.until;
    });
    return !waiting_.empty();
  }

 private:
  using Clock = std::chrono::steady_clock;

  struct Waiting {
    Ros2Call call;
    Clock::time_point until;
    Write write;
  };

  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::chrono::milliseconds kPatience{100};

  // Returns the quality of service of reader and writer. The policies that DDS compares are those of
  // rmw_qos_profile_services_default; depths and waiting times are our own.
  static Qos service_qos(const std::string& id) {
    return std::move(Qos().reliable(DDS_MSECS(5)).keep_last(64).user_data(ros2_user_data("serviceid", id)));
  }

  Reader<Request> requests_;
  Writer<Response> responses_;
  std::deque<Waiting> waiting_;
};

}  // namespace fjr::dds
