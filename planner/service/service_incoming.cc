// Incoming requests and cancellations: which are accepted, and which are refused.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "planner/service/durations.h"
#include "planner/service/service.h"

namespace fjr {
namespace {

constexpr std::chrono::seconds kMeetExecutor{2};  // an executor that was not heard by then counts as absent
constexpr std::chrono::milliseconds kSlice{5};    // time for new requests before the service does anything else

}  // namespace

// Takes all new requests from DDS first, which returns them by arrival. Then processes them, which takes ten times as
// long, with the participants in turn.
void Service::take_in() {
  const bool took_all = fill_inbox(kSlice);
  const auto end = Clock::now() + kSlice;
  while (Clock::now() < end) {
    auto order = inbox_.next();
    if (!order) {
      if (took_all) waited_ = false;
      return;
    }
    receive(std::move(*order));
  }
}

// Returns false if more requests arrive than can be taken in that time.
bool Service::fill_inbox(Clock::duration most) {
  for (const auto end = Clock::now() + most; Clock::now() < end;) {
    std::vector<Order> orders = port_.take_requests();
    if (orders.empty()) return true;
    for (Order& order : orders) inbox_.add(std::move(order));
  }
  return false;
}

void Service::receive(Order order) {
  const auto now = Clock::now();
  const auto heard = waited_ ? Clock::time_point{} : now;
  note_what_it_needs(order);
  if (answers(order)) return admit(std::move(order), now, heard);
  keep(std::move(order), now, heard, true);
}

// Keeps a request until it can be answered, here or by another instance.
void Service::keep(Order order, Clock::time_point arrived, Clock::time_point heard, bool relay) {
  no_room_for(backlog_.add(std::move(order), arrived, heard, relay));
}

// Keeps a cancellation, in case this instance has to answer when its request arrives or when the responsible instance
// is gone.
void Service::keep_cancel(const dds::ServicePort::Cancel& wanted, bool relay) {
  if (cache_.find(wanted.id)) return;
  Order cancelled;
  cancelled.id = wanted.id;
  cancelled.robot_id = wanted.robot_id.value_or("");
  if (cancelled.robot_id.empty() && ownership_.robots().size() == 1) cancelled.robot_id = config_.robot_id;
  cancelled.origin = wanted.origin;
  no_room_for(backlog_.cancel(std::move(cancelled), Clock::now(), relay));
}

void Service::no_room_for(const std::optional<Order>& dropped) {
  if (!dropped || !ownership_.answers_for(dropped->robot_id)) return;
  reject(*dropped,
         {Reason::kQueueFull, "",
          fmt::format("more than {} requests wait until the executor has been discovered", backlog_.capacity())});
}

// Returns whether the executor is known, or known to be absent. A service that has just started may not have heard it
// yet and then knows neither where the arm rests nor which epochs the executor has seen.
bool Service::knows_executor() const { return executor_.met() || Clock::now() - began_ > kMeetExecutor; }

// Notes whether the request must wait for the executor to be heard. One that would be refused anyway need not.
void Service::note_what_it_needs(Order& order) const {
  order.needs_executor =
      !knows_executor() && !refusal_at_sight(order, served(), robot_) && (executes(order) || leaves_start_out(order));
}

// Returns whether this instance is responsible for the request and knows enough to answer it.
bool Service::answers(const Order& order) const {
  return ownership_.answers_for(order.robot_id) && (!order.needs_executor || knows_executor());
}
// A cancellation without its request is answered by the owner of the robot only, since another owner may have answered
// the request long ago.
bool Service::answers(const Backlog::Entry& entry) const {
  return entry.asked ? answers(entry.order) : ownership_.owner() && entry.order.robot_id == config_.robot_id;
}

void Service::admit(Order order, Clock::time_point arrived, Clock::time_point heard) {
  presence_.heard(order.id, heard);
  if (answer_again(order)) return;
  const auto its_cancel = [&](const Backlog::Entry& entry) { return entry.cancelled && entry.order.id == order.id; };
  if (!backlog_.take_if(its_cancel).empty()) {
    return conclude({.order = std::move(order), .arrived = arrived, .cancelled = true});
  }
  tally_.received();
  if (auto refusal = refusal_of_terms(order, served())) return reject(order, std::move(*refusal));
  if (executes(order)) {
    if (const auto twice = executor_.twice()) return reject(order, {Reason::kArmNotAtRest, "", *twice});
    if (const auto stopped = executor_.stopped()) return reject(order, {Reason::kArmNotAtRest, "", *stopped});
  }
  if (queue_.full_for(order.origin)) {
    return reject(order, {Reason::kQueueFull, "",
                          fmt::format("{} requests of this client's participant wait already, {} of all",
                                      queue_.of(order.origin), queue_.size())});
  }
  if (order.action == Action::kExecute) return execute_planned(order, arrived);
  if (order.action == Action::kRepeat) return repeat_motion(order, arrived);
  if (auto refusal = read_motion(order)) return reject(order, std::move(*refusal));
  Job job;
  job.request = *order.motion;
  job.order = std::move(order);
  if (auto refusal = resolve_start(job.request)) return reject(job.order, std::move(*refusal));
  if (auto refusal = refusal_of_motion(job, robot_)) return reject(job.order, std::move(*refusal));
  job.document = format_request(job.request);
  enqueue(std::move(job), arrived);
}

Served Service::served() const { return {config_.robot_id, ownership_.robots(), robot_hash_, config_.longest_budget}; }

std::optional<Refusal> Service::resolve_start(Request& request) const {
  if (request.start) return std::nullopt;
  const auto refused = [](const std::string& why) {
    return Refusal{Reason::kArmNotAtRest, "start", "left out, but " + why};
  };
  if (motion_pending()) return refused("an earlier request has not moved the arm yet");
  const auto rest = executor_.rest();
  if (const auto* why = std::get_if<std::string>(&rest)) return refused(*why);
  request.start.emplace().q = std::get<Joints<double>>(rest);
  return std::nullopt;
}

// Executes an earlier plan. It is published under the id of this request, so that a second request to execute it, which
// has another id, moves the arm again.
void Service::execute_planned(const Order& order, Clock::time_point arrived) {
  const SharedReply planned = cache_.find(order.trajectory_id);
  if (auto refusal = refusal_of_execution(order.trajectory_id, planned, in_hand(order.trajectory_id), robot_hash_)) {
    return reject(order, std::move(*refusal));
  }
  Job job;
  job.order = order;
  job.request_hash = planned->request_hash;
  job.rest_to_rest = true;
  job.planned = planned;
  enqueue(std::move(job), arrived);
}

void Service::enqueue(Job job, Clock::time_point arrived) {
  job.arrived = arrived;
  job.deadline = arrived + duration_of(job.order.budget > 0 ? job.order.budget : config_.budget);
  const Order accepted = job.order;
  queue_.push(std::move(job));
  give_work();                        // before the reply, so that solving starts as early as possible
  if (!in_hand(accepted.id)) return;  // it has been answered already
  post(std::make_shared<const Reply>(reply_to(accepted, ReplyState::kAccepted)));
  if (log_requests_.allows()) {
    spdlog::info("accepted id={} name={} priority={} queued={}", text(accepted.id), accepted.name, accepted.priority,
                 queue_.size());
  }
}

// Answers a repeated request, which a client sends if it hears nothing, with the earlier reply, or with the news that
// it has been accepted.
bool Service::answer_again(const Order& order) {
  if (const SharedReply reply = cache_.find(order.id)) {
    tally_.duplicate();
    post(reply);
    return true;
  }
  if (!in_hand(order.id) && !being_stored(order.id)) return false;
  tally_.duplicate();
  if (being_stored(order.id)) return true;  // it is answered in a moment
  post(std::make_shared<const Reply>(reply_to(order, ReplyState::kAccepted)));
  return true;
}

void Service::cancel(const dds::ServicePort::Cancel& wanted) {
  const RequestId& id = wanted.id;
  if (!ownership_.owner()) return keep_cancel(wanted, true);
  const auto waits_for_executor = [&](const Backlog::Entry& entry) {
    return entry.asked && entry.order.id == id && ownership_.answers_for(entry.order.robot_id);
  };
  if (const auto waiting = backlog_.take_if(waits_for_executor); !waiting.empty()) return conclude(waiting.front());
  if (const SharedReply answered = cache_.find(id)) return post(answered);
  if (being_stored(id)) return;
  const auto is_it = [&](const Job& job) { return job.order.id == id; };
  if (const auto job = queue_.remove_if(is_it)) {
    return give_up(*job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it waited");
  }
  if (const auto job = solvers_.stop_if(is_it)) {
    return give_up(*job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it was solved");
  }
  if (!answers_cancel(wanted.robot_id.value_or(""))) return keep_cancel(wanted, false);
  // The request may still arrive, since requests and cancellations come on different topics.
  Job unknown;
  unknown.order.id = id;
  unknown.order.origin = wanted.origin;
  unknown.arrived = Clock::now();
  give_up(unknown, ReplyState::kCancelled, Reason::kCancelled, "cancelled before it arrived");
}

// Returns whether the cancellation of an unknown request is answered here. If several robots are served and it names
// none, another owner may know the request.
bool Service::answers_cancel(const std::string& robot_id) const {
  if (!robot_id.empty()) return ownership_.answers_for(robot_id);
  return ownership_.owner() && ownership_.robots().size() == 1;
}

// Replies to a cancelled request that was not queued.
void Service::conclude(const Backlog::Entry& entry) {
  if (answer_again(entry.order)) return;
  Job job;
  job.order = entry.order;
  job.arrived = entry.arrived;
  give_up(job, ReplyState::kCancelled, Reason::kCancelled,
          entry.asked ? "cancelled while it waited" : "cancelled before it arrived");
}

}  // namespace fjr
