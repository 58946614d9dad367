#include "planner/service/service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <thread>
#include <utility>
#include <variant>

#include "common/input_error.h"
#include "planner/service/memory.h"
#include "planner/service/overheard.h"
#include "planner/service/watchdog.h"

namespace fjr {
namespace {

constexpr std::chrono::milliseconds kHeartbeat{150};
constexpr std::chrono::milliseconds kLease{500};     // topics.h: silent for longer, an instance counts as gone
constexpr std::chrono::milliseconds kSettle{250};    // to hear of other instances, which takes 13 ms on an idle machine
constexpr std::chrono::milliseconds kGlance{5};      // how often it looks at them meanwhile
constexpr std::chrono::seconds kMeetExecutor{2};     // who was not heard by then is taken for absent
constexpr std::chrono::milliseconds kFarewell{400};  // for clients to take their last replies
constexpr std::chrono::milliseconds kSlice{5};       // for new requests, before the service looks at anything else
constexpr std::chrono::milliseconds kAnswerSoon{5};  // how often it looks whether a client that was asked is there
constexpr std::chrono::seconds kUnclaimedFor{60};    // replies wait for clients that do not listen yet
constexpr std::size_t kRemembered = 256;             // replies of each kind kept for repeated requests
constexpr std::size_t kRememberedBytes = 32 << 20;
constexpr std::size_t kRefusedLately = 4096;                              // ids
constexpr std::chrono::seconds kRelaysEnd{5};                             // a standby passes a request on for about 2 s
constexpr std::size_t kUnclaimedOfOne = 128, kUnclaimedBytes = 16 << 20;  // clients of one participant; of all
constexpr std::size_t kInboxBytes = 64 << 20;
constexpr std::size_t kOutboxBytes = 32 << 20;
constexpr std::size_t kRelayedAtOnce = 128;
constexpr std::size_t kBacklog = 1024;      // requests a standby remembers
constexpr std::size_t kAnsweredAtOnce = 4;  // of those, in one turn; a document takes up to 40 ms to be read

Refusal client_gone() {
  return {Reason::kClientGone, "", "its client was not there for longer than it may start within; send it again"};
}

double seconds(Job::Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

// What may be different a moment later, or elsewhere, is not remembered: the same request may be sent again.
bool lasting(Reason reason) {
  return reason != Reason::kQueueFull && reason != Reason::kArmNotAtRest && reason != Reason::kNoTrajectory &&
         reason != Reason::kShuttingDown && reason != Reason::kClientGone;
}

Job::Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Job::Clock::duration>(std::chrono::duration<double>(seconds));
}

std::optional<Signer> signer_of(const Network& network) {
  if (network.security.empty()) return std::nullopt;
  return Signer(network.security);
}

}  // namespace

Service::Service(const ServiceConfig& config)
    : config_(config),
      robot_(load_parameters(config.robot)),
      robot_hash_(robot_hash(robot_)),
      signer_(signer_of(config.network)),
      port_(dds::guarded_participant(config.network)),
      ownership_(config.instance, config.robot_id),
      executor_(config.robot_id, robot_hash_),
      backlog_(kBacklog),
      inbox_(kInboxBytes),
      settled_at_(Clock::now() + kSettle),
      queue_(config.queue),
      cache_(kRemembered, kRememberedBytes),
      refused_lately_(kRefusedLately, kRelaysEnd),
      unclaimed_(kUnclaimedOfOne, kUnclaimedBytes),
      outbox_([this](const SharedReply& reply) { return send(reply); }, kOutboxBytes),
      solvers_(config.workers, {config.robot, config.warm_plans}, [this] { port_.wake(); }) {
  if (config.joint_trajectory) ros_.emplace(port_.participant(), robot_, config.joint_names);
}

void Service::stop() {
  stopping_ = true;
  port_.wake();
}

void Service::run() {
  while (!stopping_) {
    if (Clock::now() >= next_heartbeat_) heartbeat();
    listen_to_others();
    meet_clients();
    outbox_.deliver();
    if (settled()) {
      for (const auto& wanted : port_.take_cancels()) cancel(wanted);
      take_in();
      relay();
      work();
      port_.wait(time_to_next());
    } else {
      std::this_thread::sleep_for(kGlance);  // requests stay where they are, and would end every wait
    }
  }
  end();
}

bool Service::settled() const {
  const auto now = Clock::now();
  return now >= settled_at_ && now - last_heartbeat_ <= kLease;
}

// ---- what comes in ----

// What has come is all taken first, for DDS gives it out by arrival; looked at, which takes ten times as long, it is in
// turn.
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

// False: more keeps coming than can be taken in that time.
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

// Until it can be answered, here or by another instance.
void Service::keep(Order order, Clock::time_point arrived, Clock::time_point heard, bool relay) {
  const auto dropped = backlog_.add(std::move(order), arrived, heard, relay);
  if (!dropped || !ownership_.answers_for(dropped->robot_id)) return;
  reject(*dropped, {Reason::kQueueFull, "",
                    fmt::format("more than {} requests wait for the executor to be met", backlog_.capacity())});
}

// A service that has just begun may not have met the executor yet: it does not know where the arm rests, nor which
// epochs the executor has seen.
bool Service::knows_executor() const { return executor_.met() || Clock::now() - began_ > kMeetExecutor; }

// What is refused whatever the executor says does not wait for it.
void Service::note_what_it_needs(Order& order) const {
  order.needs_executor =
      !knows_executor() && (executes(order) || leaves_start_out(order)) && !refusal_at_sight(order, served(), robot_);
}

// Whether it is for this instance to answer, and this instance knows enough to do so.
bool Service::answers(const Order& order) const {
  return ownership_.answers_for(order.robot_id) && (!order.needs_executor || knows_executor());
}

void Service::admit(Order order, Clock::time_point arrived, Clock::time_point heard) {
  presence_.heard(order.id, heard);
  if (repeat(order)) return;
  tally_.received();
  if (auto refusal = refusal_of_terms(order, served())) return reject(order, std::move(*refusal));
  if (const auto twice = executor_.twice(); twice && executes(order)) {
    return reject(order, {Reason::kArmNotAtRest, "", *twice});
  }
  if (queue_.full_for(order.origin)) {
    return reject(order, {Reason::kQueueFull, "", fmt::format("{} requests wait already", queue_.size())});
  }
  if (order.action == Action::kExecute) return execute_planned(order, arrived);
  Job job;
  job.order = std::move(order);
  if (auto refusal = read_motion(job)) return reject(job.order, std::move(*refusal));
  if (auto refusal = resolve_start(job.request)) return reject(job.order, std::move(*refusal));
  if (auto refusal = refusal_of_motion(job, robot_)) return reject(job.order, std::move(*refusal));
  enqueue(std::move(job), arrived);
}

Served Service::served() const { return {config_.robot_id, ownership_.robots(), robot_hash_, config_.longest_budget}; }

std::optional<Refusal> Service::resolve_start(Request& request) const {
  if (request.start) return std::nullopt;
  const auto refused = [](const std::string& why) {
    return Refusal{Reason::kArmNotAtRest, "start", "left out, but " + why};
  };
  if (motion_pending()) return refused("an earlier request is still to move the arm");
  const auto rest = executor_.rest();
  if (const auto* why = std::get_if<std::string>(&rest)) return refused(*why);
  request.start.emplace().q = std::get<Pair<double>>(rest);
  return std::nullopt;
}

// It is published under the id of the request to execute it: asked for again under another id, it moves again.
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
  give_work();  // first: telling costs time that solving can use
  post(std::make_shared<const Reply>(reply_to(accepted, ReplyState::kAccepted)));
  if (log_requests_.allows()) {
    spdlog::info("accepted id={} name={} priority={} queued={}", text(accepted.id), accepted.name, accepted.priority,
                 queue_.size());
  }
}

// A client that hears nothing asks again: it gets the reply it missed, or hears that its request is in hand.
bool Service::repeat(const Order& order) {
  if (const SharedReply reply = cache_.find(order.id)) {
    tally_.duplicate();
    post(reply);
    return true;
  }
  if (!in_hand(order.id)) return false;
  tally_.duplicate();
  post(std::make_shared<const Reply>(reply_to(order, ReplyState::kAccepted)));
  return true;
}

std::vector<const Order*> Service::orders_in_hand() const {
  std::vector<const Order*> orders;
  for (const Job* job : solvers_.jobs()) orders.push_back(&job->order);
  for (const Job& job : queue_.jobs()) orders.push_back(&job.order);
  return orders;
}

bool Service::in_hand(const RequestId& id) const {
  const auto orders = orders_in_hand();
  return std::any_of(orders.begin(), orders.end(), [&](const Order* order) { return order->id == id; });
}

bool Service::motion_pending() const {
  const auto orders = orders_in_hand();
  return std::any_of(orders.begin(), orders.end(), [](const Order* order) { return executes(*order); });
}

void Service::cancel(const dds::ServicePort::Cancel& wanted) {
  const RequestId& id = wanted.id;
  if (!ownership_.owner()) return backlog_.cancel(id, true);
  backlog_.cancel(id, false);  // it may wait for the executor
  if (const SharedReply reply = cache_.find(id)) return post(reply);
  const auto is_it = [&](const Job& job) { return job.order.id == id; };
  if (const auto job = queue_.remove_if(is_it)) {
    return give_up(*job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it waited");
  }
  if (const auto job = solvers_.stop_if(is_it)) {
    return give_up(*job, ReplyState::kCancelled, Reason::kCancelled, "cancelled while it was solved");
  }
  // Where several robots are served and it does not say which, another owner may know what this one does not.
  const bool ours = wanted.robot_id ? ownership_.answers_for(*wanted.robot_id) : ownership_.robots().size() == 1;
  if (!ours) return;
  // It may still be on its way, for the two come on different topics.
  Job unknown;
  unknown.order.id = id;
  unknown.order.origin = wanted.origin;
  give_up(unknown, ReplyState::kCancelled, Reason::kCancelled, "cancelled before it arrived");
}

// ---- whose client is still there ----

// A client that listens acknowledges what it is told, in its middleware; of one that does not, only DDS can tell.
void Service::listen_for(const Order& order) {
  if (const auto told = port_.clients().acknowledged(order.id)) return presence_.heard(order.id, *told);
  if (!port_.clients().listens(order.id) && port_.present(order.origin)) presence_.heard(order.id, Clock::now());
}

bool Service::may_start(const Order& order) {
  if (!presence_.may_start(order, Clock::now())) listen_for(order);
  return presence_.may_start(order, Clock::now());
}

// Asking is to say again that the request is in hand.
void Service::ask(const Order& order) {
  presence_.asked(order.id, Clock::now());
  if (port_.clients().listens(order.id)) {
    post(std::make_shared<const Reply>(reply_to(order, ReplyState::kAccepted)));
  }
}

void Service::look_after_clients() {
  const auto now = Clock::now();
  std::set<decltype(RequestId::client)> waiting;
  for (const Order* order : orders_in_hand()) {
    listen_for(*order);
    if (presence_.is_due(*order, now)) ask(*order);
    waiting.insert(order->id.client);
  }
  presence_.keep_if([&](const auto& client) { return waiting.contains(client); });
  const auto gone = [&](const Job& job) { return presence_.gone(job.order, now); };
  while (const auto job = queue_.remove_if(gone))
    finish(*job, reply_to(job->order, ReplyState::kCancelled, client_gone()));
  while (const auto job = solvers_.stop_if(gone))
    finish(*job, reply_to(job->order, ReplyState::kCancelled, client_gone()));
}

void Service::meet_clients() {
  if (!port_.clients().look()) return;
  const auto listens = [this](const RequestId& id) { return port_.clients().listens(id); };
  for (SharedReply& reply : unclaimed_.claim(listens)) post(std::move(reply));
}

// ---- work and time ----

void Service::work() {
  Solvers::News news = solvers_.take_news();
  for (const ProgressReport& report : news.progress) port_.clients().send(report);
  for (Job& job : news.lost) {
    if (job.lost == 1) {
      queue_.push_front(std::move(job));
    } else {
      give_up(job, ReplyState::kFailed, Reason::kWorkerLost, "two solving processes ended unexpectedly over it");
    }
  }
  for (SolveOutcome& outcome : news.outcomes) {
    const bool moves = executes(outcome.job.order) && outcome.state == ReplyState::kSolved;
    if (moves && !may_start(outcome.job.order)) {
      finish(outcome.job, reply_to(outcome.job.order, ReplyState::kCancelled, client_gone()));
      continue;
    }
    Reply reply = reply_to(outcome.job.order, outcome.state, std::move(outcome.why));
    reply.plan_json = std::move(outcome.plan_json);
    reply.errors = outcome.errors;
    reply.rows = std::move(outcome.rows);
    reply.stops = std::move(outcome.stops);
    finish(outcome.job, std::move(reply));
  }
  expire();
  give_work();
}

void Service::give_work() {
  const auto ready = [this](const Job& job) { return !executes(job.order) || may_start(job.order); };
  while (solvers_.idle()) {
    auto job = queue_.pop_if(ready);
    if (!job) return;
    solvers_.solve(std::move(*job));
  }
}

void Service::expire() {
  const auto overdue = [now = Clock::now()](const Job& job) { return job.deadline <= now; };
  while (const auto job = queue_.remove_if(overdue)) {
    give_up(*job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it waited");
  }
  while (const auto job = solvers_.stop_if(overdue)) {
    give_up(*job, ReplyState::kExpired, Reason::kBudget, "the time budget was used up while it was solved");
  }
}

std::chrono::nanoseconds Service::time_to_next() const {
  const auto now = Clock::now();
  if (!inbox_.empty() || answering_) return {};
  Clock::time_point next = std::min(next_heartbeat_, outbox_.next());
  if (!ownership_.alone()) next = std::min(next, backlog_.next_relay());
  for (const Job& job : queue_.jobs()) {
    next = std::min(next, job.deadline);
    if (executes(job.order) && !presence_.may_start(job.order, now)) next = std::min(next, now + kAnswerSoon);
  }
  for (const Job* job : solvers_.jobs()) next = std::min(next, job->deadline);
  return std::max(Clock::duration::zero(), next - now);
}

void Service::heartbeat() {
  const auto now = Clock::now();
  if (now - last_heartbeat_ > kLease) {
    // The others have taken this instance for gone: it does nothing before it knows what became of its robot.
    spdlog::warn("absent for {:.2f} s", seconds(now - last_heartbeat_));
    settled_at_ = now + kSettle;
    waited_ = true;
  }
  last_heartbeat_ = now;
  next_heartbeat_ = now + kHeartbeat;
  solvers_.replace_missing();
  port_.look_for_senders();
  look_after_clients();
  unclaimed_.forget_older_than(kUnclaimedFor);
  backlog_.forget_if([&](const Backlog::Entry& entry) {  // of its budget nothing has been checked yet
    const double budget = entry.order.budget;
    return now - entry.arrived > duration_of(budget > 0 && budget <= config_.longest_budget ? budget : config_.budget);
  });
  port_.send(status());
  tell_alive();
}

ServiceStatus Service::status() const {
  ServiceStatus status = tally_.status();
  status.instance = config_.instance;
  status.robot_id = config_.robot_id;
  status.robot_hash = robot_hash_;
  status.version = FJR_VERSION;
  status.epoch = ownership_.epoch();
  status.uptime = seconds(Clock::now() - began_);
  status.queued = static_cast<std::uint32_t>(queue_.size());
  status.queue_capacity = static_cast<std::uint32_t>(queue_.capacity());
  status.workers = static_cast<std::uint32_t>(solvers_.size());
  status.workers_lost = static_cast<std::uint32_t>(solvers_.lost());
  status.solving = static_cast<std::uint32_t>(solvers_.jobs().size());
  status.memory = resident_bytes(::getpid()) + solvers_.memory();
  return status;
}

std::vector<Order> Service::last_requests() {
  std::vector<Order> last;
  (void)fill_inbox(kFarewell);  // however many more keep coming
  while (auto order = inbox_.next()) last.push_back(std::move(*order));
  const auto ours = [this](const Backlog::Entry& entry) { return ownership_.answers_for(entry.order.robot_id); };
  for (Backlog::Entry& entry : backlog_.take_if(ours)) last.push_back(std::move(entry.order));
  return last;
}

// The standby has heard most of it already. The writer keeps the last 256 for whoever is slow: no more are under way at
// a time, as long as there is time to wait.
void Service::hand_over() {
  const auto now = Clock::now(), over = now + kFarewell;
  const auto await_taken = [&] { port_.flush_relayed(std::max(Clock::duration::zero(), over - Clock::now())); };
  std::size_t count = 0;
  const auto relay = [&](const dds::Relayed& relayed) {
    port_.relay(relayed);
    if (++count % kRelayedAtOnce == 0) await_taken();
  };
  for (const Order* order : orders_in_hand()) {
    relay({*order, seconds(now - presence_.last_heard(order->id)), false});
  }
  for (Order& order : last_requests()) relay({std::move(order), 0, false});
  await_taken();
}

// With a standby nothing needs to be asked for again: it knows the requests and takes over.
void Service::end() {
  tell_stopping();
  const bool handing_over = ownership_.has_standby();
  const auto farewell = [this](const Job& job) {
    give_up(job, ReplyState::kCancelled, Reason::kShuttingDown, "the service is shutting down; send the request again");
  };
  if (handing_over) {
    hand_over();
  } else {
    for (const Job* job : solvers_.jobs()) farewell(*job);
    while (!queue_.empty()) farewell(queue_.pop());
    for (const Order& order : last_requests()) {
      if (!ownership_.answers_for(order.robot_id)) continue;
      reject(order, {Reason::kShuttingDown, "", "the service is shutting down; send the request again"});
    }
  }
  const auto over = Clock::now() + kFarewell;
  for (outbox_.deliver(); !outbox_.empty() && Clock::now() < over; outbox_.deliver()) {
    port_.wait(std::chrono::milliseconds(1));
  }
  port_.clients().flush(over - Clock::now());
  spdlog::info("stopped handed_over={}", handing_over ? solvers_.jobs().size() + queue_.size() : 0);
}

// ---- other instances, and the executor ----

void Service::listen_to_others() {
  for (const auto& peer : port_.take_peers()) hear(peer);
  for (Reply& reply : port_.take_replies_of_others()) hear(std::move(reply));
  for (dds::Relayed& relayed : port_.take_relayed()) hear(std::move(relayed));
  for (const auto& executor : port_.take_executors()) {
    executor.alive ? executor_.heard(executor.state, executor.source) : executor_.lost(executor.state.robot_id);
  }
  for (const RequestId& id : port_.take_concluded()) executor_.concluded(id);
  if (const auto epoch = executor_.epoch()) ownership_.heard_executor(*epoch);
  if (settled()) review_ownership();
}

void Service::hear(const dds::ServicePort::Peer& peer) {
  const ServiceStatus& status = peer.status;
  if (status.instance == config_.instance) {
    const std::string problem = fmt::format("another service is running as instance {} on DDS domain {}",
                                            config_.instance, config_.network.domain);
    if (!port_.is_open() && peer.alive) throw std::runtime_error(problem);
    if (log_others_.allows()) spdlog::error(problem);
  } else if (!peer.alive) {
    if (log_others_.allows()) spdlog::info("instance gone name={}", status.instance);
    ownership_.lost(status.instance);
  } else if (status.robot_id == config_.robot_id && !ownership_.believes(status.epoch)) {
    if (log_others_.allows()) {
      spdlog::warn("instance not believed name={} epoch={}: far above what the executor has seen", status.instance,
                   status.epoch);
    }
  } else if (!status.robot_id.empty() && takes_part(status)) {
    ownership_.heard(status.instance, status.robot_id, status.epoch);
  }
}

void Service::hear(Reply reply) {
  if (!reply.final()) return backlog_.accepted(reply.id);
  reply.origin = backlog_.answered(reply.id);
  const bool of_this_robot = reply.robot_id == config_.robot_id && reply.robot_hash == robot_hash_;
  if (!of_this_robot || !lasting(reply.why.reason)) return;
  complete_overheard(reply);
  cache_.add(std::make_shared<const Reply>(std::move(reply)));
}

// Its client may have met the other instance only.
void Service::hear(dds::Relayed relayed) {
  const auto now = Clock::now();
  const auto heard = now - duration_of(relayed.silence);
  const RequestId id = relayed.order.id;
  note_what_it_needs(relayed.order);
  if (!answers(relayed.order)) {
    keep(std::move(relayed.order), now, heard, false);
    if (relayed.cancelled) backlog_.cancel(id, false);
    return;
  }
  const dds::ServicePort::Cancel wanted{id, relayed.order.robot_id, relayed.order.origin};
  if (refused_lately_.contains(id, now)) return;  // its client has been told; to ask again is the client's to decide
  admit(std::move(relayed.order), now, heard);
  if (relayed.cancelled) cancel(wanted);
}

void Service::relay() {
  if (ownership_.alone()) return;
  const auto now = Clock::now();
  backlog_.relay_due(now, [&](const Backlog::Entry& entry) {
    port_.relay({entry.order, seconds(now - entry.heard), entry.cancelled});
  });
}

// Whether it counts among those who serve their robot. One that has another idea of this one's robot does so only while
// it is the owner: what one plans, the other could not have executed, so that one of the two must not serve.
bool Service::takes_part(const ServiceStatus& other) const {
  if (other.robot_id != config_.robot_id || other.robot_hash == robot_hash_) return true;
  const bool owns = other.epoch > 0;
  if (!ownership_.owner() && (owns || !ownership_.goes_before(other.instance))) {
    throw InputError(config_.robot.string(), "",
                     fmt::format("robot_id {} is served by instance {} with another robot (hash {}, here {}): give "
                                 "both the same file, or this one a robot_id of its own",
                                 config_.robot_id, other.instance, other.robot_hash, robot_hash_));
  }
  return owns;
}

// Not before the others are known: what this instance answers, another must not answer too.
void Service::open() {
  port_.open();
  spdlog::info("serving instance={} domain={} workers={} queue={} robot={} {}", config_.instance,
               config_.network.domain, config_.workers, config_.queue, robot_hash_.substr(0, 12),
               ownership_.owner() ? "as owner" : "as standby");
  tell_ready();
}

void Service::review_ownership() {
  const bool changed = ownership_.review();
  if (!port_.is_open()) open();
  if (changed) {
    ownership_.owner() ? take_over() : give_up_ownership();
    next_heartbeat_ = {};  // the others are told at once
  }
  if (ownership_.owner()) answer_backlog();
}

void Service::take_over() {
  spdlog::info("owner robot_id={} epoch={} remembered={}", config_.robot_id, ownership_.epoch(), backlog_.size());
  port_.own(ownership_.epoch());
  if (!owned_) took_over_at_ = Clock::now();  // otherwise only its epoch has grown
  owned_ = true;
}

// What was heard while another instance, or nobody, was the owner, or before the executor was met: some at a time, for
// there may be many. A client whose request came before this instance was the owner may have left with the one before:
// nothing moves for it until it has acknowledged what it is told now.
void Service::answer_backlog() {
  std::size_t count = 0;
  const auto ours = [&](const Backlog::Entry& entry) {
    return count < kAnsweredAtOnce && answers(entry.order) && ++count > 0;
  };
  for (Backlog::Entry& entry : backlog_.take_if(ours)) {
    const dds::ServicePort::Cancel wanted{entry.order.id, entry.order.robot_id, entry.order.origin};
    const auto heard = entry.heard < took_over_at_ ? Clock::time_point{} : entry.heard;
    admit(std::move(entry.order), entry.arrived, heard);
    if (entry.cancelled) cancel(wanted);
  }
  answering_ = count == kAnsweredAtOnce;
}

// Whoever owns the robot now has heard the same requests.
void Service::give_up_ownership() {
  spdlog::warn("superseded robot_id={}", config_.robot_id);
  port_.disown();
  owned_ = false;
  const auto put_back = [this](Job job) {
    const auto heard = presence_.last_heard(job.order.id);
    keep(std::move(job.order), job.arrived, heard, true);
  };
  while (auto job = solvers_.stop_if([](const Job&) { return true; })) put_back(std::move(*job));
  while (!queue_.empty()) put_back(queue_.pop());
}

// ---- what goes out ----

Reply Service::reply_to(const Order& order, ReplyState state, Refusal why) const {
  Reply reply;
  reply.id = order.id;
  reply.state = state;
  reply.why = std::move(why);
  reply.robot_id = config_.robot_id;
  reply.robot_hash = robot_hash_;
  reply.version = FJR_VERSION;
  reply.origin = order.origin;
  return reply;
}

// Why certified rows must not move the arm after all; nothing: they may. They are never empty.
std::optional<Refusal> Service::refusal_to_publish(const std::vector<Sample>& rows) const {
  if (const auto twice = executor_.twice()) {
    return Refusal{Reason::kArmNotAtRest, "", "planned, but not executed: " + *twice};
  }
  if (rows.back().time <= kLongestMotion) return std::nullopt;
  return Refusal{Reason::kUnsupported, "duration",
                 fmt::format("planned, but not executed: it takes {:.6g} s, and an executor runs at most {:g} s",
                             rows.back().time, kLongestMotion)};
}

void Service::finish(const Job& job, Reply reply) {
  if (executes(job.order) && reply.state == ReplyState::kSolved) {
    if (auto refusal = refusal_to_publish(reply.rows)) {
      reply = reply_to(job.order, ReplyState::kFailed, std::move(*refusal));
    }
  }
  const auto now = Clock::now();
  const bool started = job.started != Clock::time_point{};
  reply.request_hash = job.request_hash;
  if (!job.robot_hash.empty()) reply.robot_hash = job.robot_hash;
  reply.rest_to_rest = job.rest_to_rest;
  reply.solve_time = started ? seconds(now - job.started) : 0;
  reply.wait_time = seconds((started ? job.started : now) - job.arrived);
  const auto shared = std::make_shared<const Reply>(std::move(reply));
  remember(shared);
  tally_.count(*shared, seconds(now - job.arrived));
  if (executes(job.order) && shared->state == ReplyState::kSolved) publish(*shared);
  post(shared);
  if (log_requests_.allows()) {
    spdlog::info("finished id={} state={} wait={:.3f} solve={:.3f} {}", text(shared->id), name(shared->state),
                 shared->wait_time, shared->solve_time, shared->why.sentence);
  }
}

void Service::give_up(const Job& job, ReplyState state, Reason reason, const std::string& sentence) {
  finish(job, reply_to(job.order, state, {reason, "", sentence}));
}

// What was refused for the moment only is not repeated from memory: the client may ask again. A standby's copy of the
// same request must not count as that.
void Service::remember(const SharedReply& reply) {
  if (lasting(reply->why.reason)) return cache_.add(reply);
  refused_lately_.add(reply->id, Clock::now());
}

void Service::reject(const Order& order, Refusal why) {
  const auto reply = std::make_shared<const Reply>(reply_to(order, ReplyState::kRejected, std::move(why)));
  remember(reply);
  tally_.count(*reply, 0);
  post(reply);
  if (log_refusals_.allows()) {
    spdlog::info("rejected id={} field={} {}", text(order.id), reply->why.field, reply->why.sentence);
  }
}

// Only a certified trajectory has rows. A repeated request is answered again but never published again, nor is what an
// earlier owner published before it could answer.
void Service::publish(const Reply& reply) {
  if (executor_.runs_or_ran(reply.id)) return spdlog::info("published before id={}", text(reply.id));
  TrajectoryOrder order;
  order.robot_id = config_.robot_id;
  order.id = reply.id;
  order.epoch = ownership_.epoch();
  order.published = executor_.stamp();
  order.robot_hash = reply.robot_hash;
  order.request_hash = reply.request_hash;
  order.certified = reply.state == ReplyState::kSolved;
  order.ends_at_rest = reply.rest_to_rest;
  order.certified_error = reply.errors.certified;
  order.predicted_error = reply.errors.predicted;
  order.rows = reply.rows;
  order.stops = reply.stops;
  if (signer_) order.signature = signer_->sign(signed_bytes(order));
  executor_.published(reply.id);
  if (!port_.send(order) && log_requests_.allows()) {
    spdlog::error("not published id={}: the executor is too slow", text(reply.id));
  }
  if (ros_) ros_->send(order);
}

// False: its client has no room for it now.
bool Service::send(const SharedReply& reply) {
  switch (port_.clients().send(*reply)) {
    case dds::Sent::kYes:
      return true;
    case dds::Sent::kNoRoom:
      return false;
    case dds::Sent::kNobodyListens:
      port_.clients().tell_standbys(*reply);
      unclaimed_.keep(reply);
      return true;
  }
  return true;
}

void Service::post(SharedReply reply) {
  const RequestId id = reply->id;
  if (!outbox_.post(std::move(reply)) && log_slow_clients_.allows()) {
    spdlog::warn("slow clients: too many replies wait, after id={} the oldest is dropped", text(id));
  }
}

}  // namespace fjr
