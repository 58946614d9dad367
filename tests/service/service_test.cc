// The planning service as its clients see it: real processes, real DDS over the loopback interface.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "planner/dds/text.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/writer.h"
#include "tests/service/service_fixture.h"

namespace fjr {
namespace {

TEST_F(ServiceTest, GivesTheSameFilesAsPlanningByOneself) {
  serve();
  write("fast.yaml", kFast);
  Process request = fjr({"request", path("fast.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  EXPECT_EQ(request.wait(), 0) << request.output();
  Process plan = fjr({"plan", path("fast.yaml"), "--out", path("b")}, "plan.log");
  EXPECT_EQ(plan.wait(), 0) << plan.output();
  EXPECT_NE(contents(path("a/trajectory.csv")), "");
  EXPECT_EQ(contents(path("a/trajectory.csv")), contents(path("b/trajectory.csv")));
  EXPECT_THAT(contents(path("a/plan.json")), HasSubstr("\"verdict\": \"certified\""));
}

// What only a document can say: an arc beyond half a turn, here 206 degrees about [0.32, -0.2] m.
TEST_F(ServiceTest, PlansAnArcTheLongWayRound) {
  serve();
  const Order arc = order(
      "start: {q: [0.33846686702355033, 2.0640669532382474]}\ngoal: {q: [0.18449583, 1.549214]}\ntip: {arc: {center: "
      "[0.32, "
      "-0.2], from: [0.32, -0.1], to: [0.36425204, -0.28967584], tolerance: 0.03, way: long}}\n");
  send(arc);
  const Reply reply = final_reply(arc.id, 60);
  ASSERT_EQ(reply.state, ReplyState::kSolved) << reply.why.sentence;
  double leftmost = 1;  // the short way round passes on the right
  for (const Sample& row : reply.rows) {
    const Joints<double>& q = row.state.q;
    leftmost = std::min(leftmost, 0.345 * std::sin(q[0]) + 0.305 * std::sin(q[0] + q[1]));
  }
  EXPECT_NEAR(leftmost, 0.32 - 0.1, 0.03);
}

TEST_F(ServiceTest, ProvesWhatIsAskedForWithProof) {
  serve();
  const Order one = order(kFast + "proven: true\n"), other = order(kFast);
  send(one);
  send(other);
  const auto proof_of = [&](const Order& asked) {
    const Reply reply = final_reply(asked.id);
    EXPECT_EQ(reply.state, ReplyState::kSolved);
    return nlohmann::json::parse(reply.plan_json)["certificate"]["proof"];
  };
  EXPECT_EQ(proof_of(one)["verdict"], "proven");
  EXPECT_TRUE(proof_of(other).is_null());
}

TEST_F(ServiceTest, SolvesTheSameIdOnce) {
  serve();
  const Order one = order(kFast);
  for (int i = 0; i < 3; ++i) send(one);
  const Reply first = final_reply(one.id);
  EXPECT_EQ(first.state, ReplyState::kSolved);
  EXPECT_GT(first.rows.size(), 100u);
  for (int i = 0; i < 2; ++i) {
    const auto asked = Clock::now();
    send(one);
    const Reply again = final_reply(one.id);
    EXPECT_LT(seconds_since(asked), 0.5);
    EXPECT_EQ(again.plan_json, first.plan_json);
    EXPECT_EQ(again.rows.size(), first.rows.size());
  }
  const ServiceStatus status = status_when([](const ServiceStatus& s) { return s.duplicates == 4; });
  EXPECT_EQ(status.received, 1u);
  EXPECT_EQ(status.solved, 1u);
}

TEST_F(ServiceTest, CancelsWhatIsBeingSolvedAndAnswersCancellingTwice) {
  serve();
  const Order slow = order(kSlow);
  send(slow);
  wait_until_solving();
  const auto asked = Clock::now();
  cancel(slow.id);
  EXPECT_EQ(final_reply(slow.id).state, ReplyState::kCancelled);
  RecordProperty("cancel_ms", static_cast<int>(1000 * seconds_since(asked)));
  EXPECT_LT(seconds_since(asked), 0.5);
  cancel(slow.id);
  EXPECT_EQ(final_reply(slow.id).state, ReplyState::kCancelled);
  const Order fast = order(kFast);
  send(fast);
  EXPECT_EQ(final_reply(fast.id).state, ReplyState::kSolved);
}

TEST_F(ServiceTest, CancelsWhatWaitsAndWhatHasNotArrived) {
  serve();
  const Order slow = order(kSlow), waiting = order(kSlow), late = order(kSlow);
  send(slow);
  send(waiting);
  cancel(late.id);
  const Reply before_it_arrived = final_reply(late.id);
  EXPECT_EQ(before_it_arrived.state, ReplyState::kCancelled);
  EXPECT_LT(before_it_arrived.wait_time, 1);  // [s] it was never there to wait
  expect_accepted(waiting.id);
  cancel(waiting.id);
  EXPECT_EQ(final_reply(waiting.id).state, ReplyState::kCancelled);
  send(late);
  EXPECT_EQ(final_reply(late.id).state, ReplyState::kCancelled);
}

TEST_F(ServiceTest, KeepsToTheBudget) {
  serve();
  Order slow = order(kSlow), waiting = order(kSlow);
  slow.budget = 0.4;
  waiting.budget = 0.3;
  const auto asked = Clock::now();
  send(slow);
  send(waiting);
  EXPECT_EQ(final_reply(waiting.id).state, ReplyState::kExpired);
  const Reply reply = final_reply(slow.id);
  EXPECT_EQ(reply.state, ReplyState::kExpired);
  EXPECT_EQ(reply.why.reason, Reason::kBudget);
  EXPECT_GE(seconds_since(asked), 0.3);
  EXPECT_LT(seconds_since(asked), 1.0);
}

// A worker may have died of something else, so what it had is tried once more.
TEST_F(ServiceTest, SurvivesTheDeathOfWorkers) {
  // Long enough to be seen at work, about 1 s.
  const std::string a_while =
      "start: {q: [0, 0]}\ngoal: {q: [1.2, -0.8]}\nduration: 1.5\nobjective: efficient\nsearch: quick\n";
  serve();
  const auto kill_while_solving = [&](std::uint64_t lost) {
    status_when([&](const ServiceStatus& status) { return status.solving == 1 && status.workers_lost == lost; });
    for (const pid_t worker : service().children()) ::kill(worker, SIGKILL);
  };
  const Order once = order(a_while);
  send(once);
  kill_while_solving(0);
  EXPECT_EQ(final_reply(once.id).state, ReplyState::kSolved);
  status_when([](const ServiceStatus& status) { return status.solving == 0 && status.workers_lost == 1; });  // of once
  const Order slow = order(kSlow);
  send(slow);
  kill_while_solving(1);
  kill_while_solving(2);
  const Reply reply = final_reply(slow.id);
  EXPECT_EQ(reply.state, ReplyState::kFailed);
  EXPECT_EQ(reply.why.reason, Reason::kWorkerLost);
  status_when([](const ServiceStatus& status) { return status.workers_lost == 3; });
}

TEST_F(ServiceTest, AnswersWhatIsInFlightWhenItEnds) {
  serve();
  const Order slow = order(kSlow), waiting = order(kSlow);
  send(slow);
  send(waiting);
  wait_until_solving();
  const auto asked = Clock::now();
  service().send(SIGTERM);
  for (const RequestId& id : {slow.id, waiting.id}) {
    const Reply reply = final_reply(id, 2);
    EXPECT_EQ(reply.state, ReplyState::kCancelled);
    EXPECT_EQ(reply.why.reason, Reason::kShuttingDown);
  }
  EXPECT_EQ(service().wait(), 0);
  EXPECT_LT(seconds_since(asked), 1.0);
}

TEST_F(ServiceTest, LeavesNoWorkerBehindWhenItIsKilled) {
  serve();
  const Order slow = order(kSlow);
  send(slow);
  wait_until_solving();
  const std::vector<pid_t> workers = service().children();
  ASSERT_EQ(workers.size(), 1u);
  service().send(SIGKILL);
  EXPECT_EQ(service().wait(), -1);
  const auto gone = [&] { return contents("/proc/" + std::to_string(workers[0]) + "/comm").empty(); };
  for (const auto began = Clock::now(); !gone() && seconds_since(began) < 5;) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_TRUE(gone());
}

TEST_F(ServiceTest, RefusesWhatDoesNotFitTheQueue) {
  serve("{workers: 1, queue: 2}\n");
  std::vector<Order> orders;
  orders.push_back(order(kSlow));
  send(orders.back());
  wait_until_solving();
  for (int i = 0; i < 4; ++i) {
    orders.push_back(order(kSlow));
    send(orders.back());
  }
  for (const std::size_t refused : {3, 4}) {
    const Reply reply = final_reply(orders[refused].id);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    EXPECT_EQ(reply.why.reason, Reason::kQueueFull);
  }
}

// A plan library outlives the service that has learnt into it.
TEST_F(ServiceTest, StartsFromWhatItHasLearntBeforeItWasRestarted) {
  const std::string configuration = "{workers: 1, warm_plans: 0, library: learnt}\n";
  serve(configuration);
  const Order first = order(kFast);
  send(first);
  ASSERT_EQ(final_reply(first.id).state, ReplyState::kSolved);
  const auto is_learnt = [&] {  // the client has its answer before
    Process status = fjr({"library", "status", path("learnt").string(), "--json"}, "status.log");
    return status.wait() == 0 && status.output().find("\"plans\": 1") != std::string::npos;
  };
  const auto began = Clock::now();
  while (!is_learnt() && seconds_since(began) < 10) listen();
  service().send(SIGTERM);
  EXPECT_EQ(service().wait(), 0);

  serve(configuration);
  const Order beside = order("start: {q: [0.3, 0.2]}\ngoal: {q: [0.421, 0.08]}\nobjective: fastest\n");
  send(beside);
  const auto plan = nlohmann::json::parse(final_reply(beside.id).plan_json);
  EXPECT_EQ(plan["status"], "certified");
  EXPECT_EQ(plan["warm"]["from"], "request");
  EXPECT_NEAR(plan["warm"]["away_rad"], 0.001, 1e-12);
}

// One client's requests, however many, make another wait for one of them at most; with their client they leave.
TEST_F(ServiceTest, AGreedyClientDelaysNobody) {
  serve("{workers: 1, warm_plans: 0}\n");
  auto greedy = std::make_unique<dds::ClientPort>(dds::Participant(domain_), new_client());
  while (!greedy->served()) greedy->wait(milliseconds(5));
  // All of them take longer than the service takes to see that their client is gone.
  Order one_of_many = order(kMedium);
  one_of_many.id = new_client();
  for (int i = 0; i < 70; ++i) {
    ++one_of_many.id.number;
    EXPECT_TRUE(greedy->send(one_of_many));
  }
  status_when([](const ServiceStatus& status) { return status.queued > 50; });
  const auto asked = Clock::now();
  const Order one = order(kFast);
  send(one);
  EXPECT_EQ(final_reply(one.id).state, ReplyState::kSolved);
  const double took = seconds_since(asked);
  const ServiceStatus then = status_when([](const ServiceStatus& status) { return status.solved >= 2; });
  EXPECT_LT(then.solved, 10u);  // about 60 would have come first
  greedy.reset();
  const auto left = Clock::now();
  status_when([](const ServiceStatus& status) { return status.queued == 0 && status.solving == 0; }, 12);
  std::printf("answered after %.1f s; the others left after %.1f s\n", took, seconds_since(left));
  EXPECT_GT(status_when([](const ServiceStatus&) { return true; }).cancelled, 10u);
}

TEST_F(ServiceTest, RefusesByName) {
  serve();
  const auto refusal = [&](const Order& bad) {
    send(bad);
    const Reply reply = final_reply(bad.id);
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    return reply.why.field + ": " + reply.why.sentence;
  };
  EXPECT_EQ(refusal(order("start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n")), "goal.q[1]: 3.4 rad is outside [-2.6, 2.6]");
  Order loaded = order(kFast + "payload: {mass: 0.1}\n");
  loaded.action = Action::kPlanAndExecute;
  EXPECT_THAT(refusal(loaded), HasSubstr("payload: the executor does not know of it"));
  Order other_robot = order(kFast);
  other_robot.robot_hash = "0123";
  EXPECT_THAT(refusal(other_robot), HasSubstr("robot: the service plans for the robot with hash"));
  Order long_budget = order(kFast);
  long_budget.budget = 1e6;
  EXPECT_THAT(refusal(long_budget), HasSubstr("budget: 1000000 s is above 600 s"));
}

// Every number a request can carry, by the name under which it is refused.
struct Field {
  std::string name;
  double* value;
};

void add_pair(std::vector<Field>& fields, const std::string& name, double (&pair)[2]) {
  for (int j = 0; j < 2; ++j) fields.push_back({fmt::format("{}[{}]", name, j), &pair[j]});
}

// A message in which all that is optional is given; `kind` chooses among what excludes each other.
struct FullRequest {
  FullRequest(const Order& order, int kind) : wire(dds::encode_plan_request(order)), via(2), obstacles(1), path(2) {
    fjr_msg_PlanRequest& m = wire.message.request;
    m.start.has_dq = m.start.has_theta = m.start.has_dtheta = true;
    m.goal.has_dq = m.goal.has_theta = m.goal.has_dtheta = m.goal.has_tip_velocity = true;
    m.goal.kind = kind == 0 ? fjr_msg_GOAL_JOINTS : fjr_msg_GOAL_TIP;
    m.duration = {true, 0.5, true, 1.5};
    m.objective = {fjr_msg_OBJECTIVE_WEIGHTS, 1, 1, 1, 1, 1, 1};
    for (auto& point : via) point.has_time = point.has_dq = true;
    via[0].time = 0.2;
    via[1].time = 0.3;
    obstacles[0].radius = 0.1;
    m.tip.kind = static_cast<std::uint8_t>(kind);  // free, box, line, arc
    m.limits = {true, {1, 1}, true, {1, 1}, true, {1, 1}, true, {1, 1}, true, {0.1, 0.1}, true, 1};
    m.payload.given = m.has_sample_period = true;
    m.sample_period = 0.001;
    m.via = {2, 2, via.data(), false};
    m.obstacles = {1, 1, obstacles.data(), false};
    wire.message.copper = wire.message.peak_torque = wire.message.tip_speed = 1;
    wire.message.path = {true, {2, 2, path.data(), false}, 0.01};
  }

  std::vector<Field> fields(int kind) {
    fjr_msg_PlanRequest& m = wire.message.request;
    std::vector<Field> all;
    add_pair(all, "start.q", m.start.q);
    add_pair(all, "start.dq", m.start.dq);
    add_pair(all, "start.theta", m.start.theta);
    add_pair(all, "start.dtheta", m.start.dtheta);
    if (kind == 0) add_pair(all, "goal.q", m.goal.q);
    if (kind != 0) add_pair(all, "goal.tip", m.goal.tip);
    if (kind != 0) add_pair(all, "goal.tip_velocity", m.goal.tip_velocity);
    add_pair(all, "goal.dq", m.goal.dq);
    add_pair(all, "goal.theta", m.goal.theta);
    add_pair(all, "goal.dtheta", m.goal.dtheta);
    all.push_back({"duration.min", &m.duration.min});
    all.push_back({"duration.max", &m.duration.max});
    all.push_back({"objective.time", &m.objective.time});
    all.push_back({"objective.effort", &m.objective.effort});
    all.push_back({"objective.torque_rate", &m.objective.torque_rate});
    all.push_back({"objective.link_acceleration", &m.objective.link_acceleration});
    all.push_back({"objective.link_jerk", &m.objective.link_jerk});
    all.push_back({"objective.energy", &m.objective.energy});
    all.push_back({"objective.copper", &wire.message.copper});
    all.push_back({"objective.peak_torque", &wire.message.peak_torque});
    all.push_back({"objective.tip_speed", &wire.message.tip_speed});
    all.push_back({"via[1].time", &via[1].time});
    add_pair(all, "via[1].q", via[1].q);
    add_pair(all, "via[1].dq", via[1].dq);
    add_pair(all, "obstacles[0].center", obstacles[0].center);
    all.push_back({"obstacles[0].radius", &obstacles[0].radius});
    all.push_back({"obstacles[0].margin", &obstacles[0].margin});
    if (kind == 1) add_pair(all, "tip.box[0]", m.tip.lower);
    if (kind == 1) add_pair(all, "tip.box[1]", m.tip.upper);
    for (const auto& [shape, word] : {std::pair{2, "tip.line"}, {3, "tip.arc"}}) {
      if (kind != shape) continue;
      if (shape == 3) add_pair(all, "tip.arc.center", m.tip.center);
      add_pair(all, fmt::format("{}.from", word), m.tip.from);
      add_pair(all, fmt::format("{}.to", word), m.tip.to);
      all.push_back({fmt::format("{}.tolerance", word), &m.tip.tolerance});
    }
    add_pair(all, "limits.torque", m.limits.torque);
    add_pair(all, "limits.torque_rate", m.limits.torque_rate);
    add_pair(all, "limits.motor_velocity", m.limits.motor_velocity);
    add_pair(all, "limits.link_position", m.limits.link_position);
    add_pair(all, "limits.spring_deflection", m.limits.spring_deflection);
    all.push_back({"limits.tip_speed", &m.limits.tip_speed});
    all.push_back({"payload.mass", &m.payload.mass});
    all.push_back({"payload.inertia", &m.payload.inertia});
    add_pair(all, "path.points[1]", path[1].q);
    all.push_back({"path.tolerance", &wire.message.path.tolerance});
    all.push_back({"sample_period", &m.sample_period});
    all.push_back({"budget", &m.budget});
    return all;
  }

  dds::WireRequest wire;
  std::vector<fjr_msg_ViaPoint> via;
  std::vector<fjr_msg_Disc> obstacles;
  std::vector<fjr_msg_Posture> path;
};

// DDS carries any number.
TEST_F(ServiceTest, RefusesEveryFieldThatIsNotANumberByName) {
  serve();
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_PlanRequest2> writer(participant, participant.handle());
  while (!writer.has_reader()) std::this_thread::sleep_for(milliseconds(5));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  int checked = 0;
  for (int kind = 0; kind < 4; ++kind) {
    const std::size_t count = FullRequest(order(kFast), kind).fields(kind).size();
    for (std::size_t i = 0; i < count; ++i) {
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}) {
        const Order one = order(kFast);
        FullRequest request(one, kind);
        const Field field = request.fields(kind)[i];
        *field.value = bad;
        ASSERT_TRUE(writer.write(request.wire.message));
        const Reply reply = final_reply(one.id, 5);
        EXPECT_EQ(reply.state, ReplyState::kRejected);
        EXPECT_EQ(reply.why.field, field.name) << bad << ": " << reply.why.sentence;
        EXPECT_THAT(reply.why.sentence, HasSubstr("finite"));
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 500);
}

TEST_F(ServiceTest, RefusesWhatIsOutsideLimitsByName) {
  serve();
  const auto refused_field = [&](const std::string& yaml) {
    const Order bad = order(yaml);
    send(bad);
    const Reply reply = final_reply(bad.id, 5);
    EXPECT_EQ(reply.state, ReplyState::kRejected) << yaml;
    return reply.why.field;
  };
  const std::string fixed = "start: {q: [0, 0]}\ngoal: {q: [0.4, 0.2]}\nduration: 1\nobjective: efficient\n";
  EXPECT_EQ(refused_field("start: {q: [-3.3, 0]}\ngoal: {q: [0, 0]}\n"), "start.q[0]");
  EXPECT_EQ(refused_field("start: {q: [0, 0], dq: [0, 1e300]}\ngoal: {q: [0.3, 0]}\n"), "start.dq[1]");
  EXPECT_EQ(refused_field("start: {q: [0, 0], dtheta: [9, 0]}\ngoal: {q: [0.3, 0]}\n"), "start.dtheta");
  EXPECT_EQ(refused_field(kFast + "duration: {max: 1e300}\n"), "duration.max");
  EXPECT_EQ(refused_field(kFast + "duration: {min: 2, max: 1}\n"), "duration");
  EXPECT_EQ(refused_field(kFast + "limits: {torque: [10, 1e300]}\n"), "limits.torque[1]");
  EXPECT_EQ(refused_field(kFast + "limits: {tip_speed: -1}\n"), "limits.tip_speed");
  EXPECT_EQ(refused_field(kFast + "sample_period: 1e300\n"), "sample_period");
  EXPECT_EQ(refused_field(fixed + "via: [{time: 0.6, q: [0, 0]}, {time: 0.3, q: [0, 0]}]\n"), "via[1].time");
  EXPECT_EQ(refused_field(fixed + "via: [{time: 0.6, q: [0, 3]}]\n"), "via[0].q[1]");
}

// A document is whatever its sender wrote: none of it may cost the service more than a glance.
TEST_F(ServiceTest, RefusesDocumentsThatAreNoRequests) {
  serve();
  const dds::Participant participant(domain_);
  dds::Writer<fjr_msg_MotionRequest> writer(participant, participant.handle());
  while (!writer.has_reader()) std::this_thread::sleep_for(milliseconds(5));
  const auto repeated = [](const std::string& text, std::size_t count) {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += text;
    return all;
  };
  const auto refusal = [&](const std::string& document) {
    const Order one = order(kFast);
    fjr_msg_MotionRequest message = dds::encode(one);
    dds::set_text(message.document, document);
    const auto asked = Clock::now();
    EXPECT_TRUE(writer.write(message));
    const Reply reply = final_reply(one.id, 5);
    EXPECT_LT(seconds_since(asked), 1) << reply.why.sentence;
    EXPECT_EQ(reply.state, ReplyState::kRejected);
    return reply.why.field + ": " + reply.why.sentence;
  };
  EXPECT_EQ(refusal(""), "document: empty");
  EXPECT_THAT(refusal("just words"), HasSubstr("document: must be a map with the keys robot, start, goal"));
  EXPECT_THAT(refusal("- 1\n- 2\n"), HasSubstr("objective, via, obstacles, walls, tip, path, limits, sample_period, "
                                               "seed, payload, method, search, robust, proven, not a list of 2"));
  EXPECT_THAT(refusal("goal: {q: [1, 0]"), HasSubstr("not valid YAML"));
  EXPECT_EQ(refusal(kFast + "robot: /etc/passwd\n"), "robot: the robot is given already");
  EXPECT_THAT(refusal(kFast + "include: other.yaml\n"), HasSubstr("unknown key \"include\""));
  EXPECT_THAT(refusal("goal: &a {q: [1, 0]}\nstart: *a\n"), HasSubstr("anchors (&name) are not allowed"));
  EXPECT_THAT(refusal("goal: !!python/object {q: [1, 0]}\n"), HasSubstr("tags (!name) are not allowed"));
  EXPECT_THAT(refusal(kFast + "---\n" + kFast), HasSubstr("more than one YAML document"));
  EXPECT_THAT(refusal("goal: " + repeated("[", 65000)), HasSubstr("line 1: "));
  EXPECT_THAT(refusal(repeated("- ", 32000)), HasSubstr("nested deeper than 16 levels"));
  EXPECT_THAT(refusal("goal: [" + repeated("1,", 32000) + "1]"), HasSubstr("more than 20000 values"));
  EXPECT_THAT(refusal(repeated("? ", 32000)), HasSubstr("must be text"));
  EXPECT_THAT(refusal(repeated("\xff", 65000)), HasSubstr("document: "));
  EXPECT_THAT(refusal(kFast + "goal: {q: [1, 0]}\n"), HasSubstr("key \"goal\" is given twice"));
}

TEST_F(ServiceTest, ClientSaysWhenNobodyServes) {
  write("fast.yaml", kFast);
  Process request = fjr({"request", path("fast.yaml"), "--domain", domain(), "--find", "0.3"}, "request.log");
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("nobody serves plan requests on DDS domain " + domain()));
}

TEST_F(ServiceTest, ClientSaysWhenTheServiceIsSilent) {
  serve();
  write("slow.yaml", kSlow);
  Process request = fjr({"request", path("slow.yaml"), "--domain", domain(), "--silence", "1"}, "request.log");
  wait_until_solving();
  service().send(SIGSTOP);
  EXPECT_EQ(request.wait(), 1);
  EXPECT_THAT(request.output(), HasSubstr("has not answered for 1 s"));
}

TEST_F(ServiceTest, ClientCancelsWhenInterrupted) {
  serve();
  write("slow.yaml", kSlow);
  Process request = fjr({"request", path("slow.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  wait_until_solving();
  request.send(SIGINT);
  EXPECT_EQ(request.wait(), 5) << request.output();
  EXPECT_THAT(contents(path("a/plan.json")), HasSubstr("\"status\": \"cancelled\""));
  EXPECT_FALSE(fs::exists(path("a/trajectory.csv")));
}

TEST_F(ServiceTest, TellsHowItIsDoing) {
  serve();
  const Order fast = order(kFast);
  send(fast);
  EXPECT_EQ(final_reply(fast.id).state, ReplyState::kSolved);
  Process status = fjr({"status", "--domain", domain(), "--json"}, "status.log");
  EXPECT_EQ(status.wait(), 0);
  EXPECT_THAT(status.output(), HasSubstr("\"solved\": 1"));
}

// Each waits for its turn, all are answered.
TEST_F(ServiceTest, ServesManyClientsAtOnce) {
  serve();
  write("bad.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
  write("fast.yaml", kFast);
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < 30; ++i) {
    const std::string file = path(i % 10 == 0 ? "fast.yaml" : "bad.yaml").string();
    clients.push_back(std::make_unique<Process>(
        std::vector<std::string>{FJR_EXECUTABLE, "request", file, "--domain", domain()}, path(std::to_string(i))));
  }
  for (std::size_t i = 0; i < clients.size(); ++i) {
    EXPECT_EQ(clients[i]->wait(), i % 10 == 0 ? 0 : 2) << clients[i]->output();
  }
}

// A client that keeps asking meets the service again.
TEST_F(ServiceTest, ClientOutlivesTheService) {
  serve();
  write("medium.yaml", kMedium);
  Process request = fjr({"request", path("medium.yaml"), "--domain", domain(), "--out", path("a")}, "request.log");
  wait_until_solving();
  service().send(SIGKILL);
  EXPECT_EQ(service().wait(), -1);
  serve();
  EXPECT_EQ(request.wait(), 0) << request.output();
  EXPECT_TRUE(fs::exists(path("a/trajectory.csv")));
}

TEST_F(ServiceTest, ClientPassesOnTheRefusal) {
  serve();
  write("bad.yaml", "start: {q: [0, 0]}\ngoal: {q: [1.2, 3.4]}\n");
  Process request = fjr({"request", path("bad.yaml"), "--domain", domain()}, "request.log");
  EXPECT_EQ(request.wait(), 2);
  EXPECT_THAT(request.output(), HasSubstr("goal.q[1]: 3.4 rad is outside [-2.6, 2.6]"));
}

}  // namespace
}  // namespace fjr
