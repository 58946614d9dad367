// The parts of the service that need neither processes nor DDS: documents and the wire, the queue, remembered replies.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/input_error.h"
#include "common/strict_yaml.h"
#include "planner/dds/participant.h"
#include "planner/dds/reach.h"
#include "planner/dds/text.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/wire_reply.h"
#include "planner/dds/wire_request.h"
#include "planner/dds/wire_work.h"
#include "planner/problem/problem.h"
#include "planner/protocol/document.h"
#include "planner/protocol/signature.h"
#include "planner/request/request.h"
#include "planner/service/frames.h"
#include "planner/service/job_queue.h"
#include "planner/service/reply_cache.h"
#include "tests/support/domain.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::string kShort = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.42, 0.08]}\n";

Order order_of(const std::string& yaml) {
  Order order;
  order.id.number = 7;
  order.name = "request.yaml";
  order.document = yaml;
  return order;
}

Problem resolved(const std::string& yaml) { return parse_request(yaml, "request.yaml", {}, default_robot_file()); }

// What becomes of `yaml` on the wire, by MotionRequest and by PlanRequest2.
std::string as_motion_request(const std::string& yaml) {
  const Order received = dds::decode(dds::encode(order_of(yaml)));
  EXPECT_FALSE(received.refusal) << received.refusal->field << received.refusal->sentence;
  return received.document;
}
Request as_plan_request(const std::string& yaml) {
  const dds::WireRequest wire = dds::encode_plan_request(order_of(yaml));
  const Order received = dds::decode(wire.message);
  EXPECT_FALSE(received.refusal) << received.refusal->field << received.refusal->sentence;
  EXPECT_EQ(received.document, "");
  return received.motion.value();
}
Problem resolved(const Request& request) { return resolve_for(request, load_parameters(default_robot_file())); }

std::vector<std::string> hashes_by_wire(const std::string& yaml) {
  return {resolved(as_motion_request(yaml)).request_hash, resolved(as_plan_request(yaml)).request_hash};
}
std::vector<std::string> twice(const std::string& hash) { return {hash, hash}; }

TEST(Wire, EveryExampleArrivesAsTheSameProblem) {
  int examples = 0;
  for (const auto& entry : fs::directory_iterator(FJR_SOURCE_DIR "/config/requests")) {
    const std::string yaml = contents(entry.path());
    const std::string hash = resolved(yaml).request_hash;
    if (yaml.find("\nwalls:") == std::string::npos) {
      EXPECT_EQ(hashes_by_wire(yaml), twice(hash)) << entry.path();
    } else {  // which the older types have no place for
      EXPECT_EQ(resolved(as_motion_request(yaml)).request_hash, hash) << entry.path();
      EXPECT_THROW(as_plan_request(yaml), InputError);
    }
    ++examples;
  }
  EXPECT_GT(examples, 5);
}

// `inf` for the other joint says that it has no limit of its own; the older types have no place for that.
TEST(Wire, ALimitOfOneJointIsNotDroppedForAnOlderService) {
  for (const std::string limits : {"[.inf, 3]", "[3, .inf]"}) {
    const std::string yaml = kShort + "limits: {torque: " + limits + "}\n";
    EXPECT_EQ(resolved(as_motion_request(yaml)).request_hash, resolved(yaml).request_hash);
    try {
      (void)as_plan_request(yaml);
      ADD_FAILURE() << limits;
    } catch (const InputError& error) {
      EXPECT_EQ(error.field(), "limits.torque");
    }
  }
}

// A process may be a server or a client of something else, as Python's are.
TEST(Participant, LeavesOtherSocketsOfTheProcessAlone) {
  const auto is_bound = [](int descriptor) {
    std::array<char, 64> device{};
    auto size = static_cast<socklen_t>(device.size());
    EXPECT_EQ(::getsockopt(descriptor, SOL_SOCKET, SO_BINDTODEVICE, device.data(), &size), 0);
    return size > 0 && device[0] != '\0';
  };
  const int server = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in anywhere{};
  anywhere.sin_family = AF_INET;
  ASSERT_EQ(::bind(server, reinterpret_cast<const sockaddr*>(&anywhere), sizeof anywhere), 0);
  ASSERT_EQ(::listen(server, 1), 0);
  const std::set<std::string> before = dds::open_sockets();
  const dds::Participant participant(own_domain());
  EXPECT_GT(dds::open_sockets().size(), before.size());
  EXPECT_TRUE(dds::sends_only_over_loopback());
  EXPECT_FALSE(is_bound(server));
  ::close(server);
}

// What is asked in numbers meets the same bounds as what is asked in a document, in the same words.
TEST(Wire, NumbersAreJudgedAsTheirDocument) {
  const auto error_of = [](auto&& judged) {
    try {
      (void)judged();
      return std::string("no error");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  const auto set_payload = [](fjr_msg_PlanRequest& message, double mass, double inertia) {
    message.payload.given = true;
    message.payload.mass = mass;
    message.payload.inertia = inertia;
  };
  const std::vector<std::function<void(fjr_msg_PlanRequest&)>> breaks{
      [&](auto& message) { set_payload(message, 11, 0); },
      [&](auto& message) { set_payload(message, -0.1, 0); },
      [&](auto& message) { set_payload(message, 0.1, 2); },
      [](auto& message) { message.goal.q[0] = 9; },
      [](auto& message) { message.has_sample_period = true, message.sample_period = 1; },
      [](auto& message) { message.limits.has_torque = true, message.limits.torque[1] = -1; },
      [](auto& message) { message.objective.preset = fjr_msg_OBJECTIVE_WEIGHTS, message.objective.time = -1; },
      [](auto& message) { message.duration.has_min = true, message.duration.min = 1e9; },
      [](auto& message) { message.start.has_dq = true, message.start.dq[0] = 1e3; }};
  for (const auto& break_it : breaks) {
    dds::WireRequest wire = dds::encode_plan_request(order_of(kShort));
    break_it(wire.message.request);
    const Request request = dds::decode(wire.message).motion.value();
    const std::string error = error_of([&] { return resolved(request); });
    EXPECT_NE(error, "no error");
    EXPECT_EQ(error, error_of([&] { return resolved(format_request(request)); }));
  }
}

// To another service it goes as a document, whichever type it came as.
TEST(Wire, WhatCameAsNumbersIsPassedOnAsADocument) {
  const dds::WireRequest wire = dds::encode_plan_request(order_of(kShort));
  const dds::Relayed relayed = dds::decode(dds::encode(dds::Relayed{.order = dds::decode(wire.message)}));
  EXPECT_FALSE(relayed.order.motion);
  EXPECT_EQ(resolved(relayed.order.document).request_hash, resolved(kShort).request_hash);
}

// It is counted in nanoseconds afterwards, of which there are not enough for every number that can be sent.
TEST(Wire, ASilenceOfAnyLengthIsOneOfADayAtMost) {
  const auto silence_of = [](double sent) {
    return dds::decode(dds::encode(dds::Relayed{.order = order_of(kShort), .silence = sent})).silence;
  };
  EXPECT_EQ(silence_of(2.5), 2.5);
  EXPECT_EQ(silence_of(86400), 86400);
  for (const double long_one : {86401.0, 1e300, kInfinity}) EXPECT_EQ(silence_of(long_one), 86400);
  for (const double none : {-1.0, -kInfinity, kNan}) EXPECT_EQ(silence_of(none), 0);
}

TEST(Wire, NumbersArriveToTheLastBit) {
  const std::string yaml =
      "start: {q: [0.1, -0.30000000000000004], dq: [1e-17, 0.2]}\ngoal: {q: [1.2345678901234567, 0], dq: [0.1, 0.2]}\n"
      "duration: {min: 0.30000000000000004}\nobjective: {time: 3, effort: 0.1}\nseed: 18446744073709551615\n"
      "limits: {torque: [11.1, 4.9], tip_speed: 3.3}\nsample_period: 0.002\n";
  EXPECT_EQ(hashes_by_wire(yaml), twice(resolved(yaml).request_hash));
}

TEST(Wire, TasksAndSetsArriveAsTheyWere) {
  for (const std::string yaml :
       {"start: {q: [0, 0]}\ngoal: {tip: [0.3, -0.4], elbow: left}\nobstacles: [{center: [0.1, 0.6], radius: 0.05}]\n",
        "start: {q: [0, 0]}\ngoal: {q: [free, 1]}\ntip: {box: [[-0.7, -0.7], [0.7, 0.3]]}\n",
        "start: {q: [0, 0]}\ngoal: {q: [1, 0]}\nvia: [{q: [0.5, 0.2]}, {q: [0.6, 0.1], dq: [0, 1]}]\n",
        "start: {q: [0, 0]}\ngoal: {q: [1, 0]}\n"
        "tip: {arc: {center: [0, 0], from: [0, -0.65], to: [0.65, 0], tolerance: 0.1}}\n"}) {
    EXPECT_EQ(hashes_by_wire(yaml), twice(resolved(yaml).request_hash)) << yaml;
  }
}

TEST(Wire, ArcsBeyondHalfATurnArriveAndServicesFromBeforeAreNotAsked) {
  const auto arc = [](const char* way) {
    return "start: {q: [0.33846686702355033, 2.0640669532382474]}\ngoal: {q: [0.33094525650277518, "
           "1.4959281989151574]}\n"
           "tip: {arc: {center: [0.32, -0.2], from: [0.32, -0.1], to: [0.407158, -0.249026], tolerance: 0.03" +
           std::string(way) + "}}\n";
  };
  const std::string longer = arc(", way: long");
  EXPECT_EQ(resolved(as_motion_request(longer)).request_hash, resolved(longer).request_hash);
  EXPECT_NE(resolved(longer).request_hash, resolved(arc("")).request_hash);
  EXPECT_EQ(hashes_by_wire(arc(", way: short")), twice(resolved(arc("")).request_hash));
  try {
    (void)dds::encode_plan_request(order_of(longer));
    ADD_FAILURE() << "would have come as the short way";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("tip.arc.way"));
    EXPECT_THAT(error.what(), HasSubstr("older version"));
  }
}

TEST(Wire, PayloadsAndTermsArriveAsTheyWere) {
  for (const char* more : {"payload: 0.1\n", "payload: {mass: {value: 0.1, unit: kg}, inertia: 0.001}\n",
                           "objective: {time: 1, link_jerk: 1e-6, energy: 0.5}\n"}) {
    EXPECT_EQ(hashes_by_wire(kShort + more), twice(resolved(kShort + more).request_hash)) << more;
    EXPECT_NE(resolved(kShort + more).request_hash, resolved(kShort).request_hash) << more;
  }
}

// PlanRequest2 carries what PlanRequest has no place for, and only that needs it.
TEST(Wire, WhatPlanRequestHasNoPlaceForArrivesByTheSecond) {
  const std::string vias = "via: [{q: [0.35, 0.1], release: true}, {q: [0.4, 0.1], release: false}]\n";
  for (const std::string& yaml :
       {kShort + "objective: {time: 1, copper: 1}\n", kShort + "objective: {time: 1, peak_torque: 0.1}\n",
        kShort + "objective: {time: 1, tip_speed: 0.3}\nduration: {max: 2}\n" + vias, kShort + vias,
        kShort + "path: {tolerance: 0.01}\n", kShort + "path: {points: [[0.3, 0.1], [0.4, 0.1]], tolerance: 0.02}\n",
        std::string("start: {q: [0, 0]}\ngoal: {q: [1, 0], dq: free}\n")}) {
    EXPECT_EQ(hashes_by_wire(yaml), twice(resolved(yaml).request_hash)) << yaml;
    EXPECT_FALSE(dds::fits_plan_request(dds::encode_plan_request(order_of(yaml)).message)) << yaml;
  }
  EXPECT_TRUE(dds::fits_plan_request(
      dds::encode_plan_request(order_of(kShort + "objective: {time: 1, energy: 1}\nvia: [{q: [0, 0]}]\n")).message));
}

TEST(Wire, KeysThatCameLaterAreRefusedByName) {
  for (const auto& [key, value] : {std::pair{"method", "lobatto4"},
                                   {"search", "quick"},
                                   {"walls", "[{point: [0, 0.7], normal: [0, -1]}]"},
                                   {"robust", "{confidence: 0.9}"},
                                   {"proven", "true"}}) {
    const std::string yaml = fmt::format("{}{}: {}\n", kShort, key, value);
    EXPECT_THAT([&] { (void)dds::encode_plan_request(order_of(yaml)); },
                testing::ThrowsMessage<InputError>(testing::AllOf(HasSubstr(key), HasSubstr("older version"))))
        << yaml;
  }
}

TEST(Wire, NumbersThatAreNotFiniteAreRefusedByName) {
  const auto refusal = [](auto change) {
    dds::WireRequest wire = dds::encode_plan_request(order_of(
        kShort + "duration: 1\nobjective: efficient\nvia: [{time: 0.3, q: [0, 0]}, {time: 0.5, q: [0, 0]}]\n"));
    change(wire);
    const Order order = dds::decode(wire.message);
    return order.refusal ? order.refusal->field + ": " + order.refusal->sentence : "none";
  };
  using Wire = dds::WireRequest;
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.goal.q[1] = kNan; }), "goal.q[1]: nan is not finite");
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.start.q[0] = -kInfinity; }), "start.q[0]: -inf is not finite");
  EXPECT_EQ(refusal([](Wire& w) { w.via[1].q[0] = kNan; }), "via[1].q[0]: nan is not finite");
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.budget = kNan; }), "budget: nan s must be finite and not negative");
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.goal.kind = 9; }), "goal.kind: 9 is not one of 0 to 1");
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.objective.preset = 200; }), "objective: 200 is not one of 0 to 4");
  EXPECT_EQ(refusal([](Wire& w) { w.message.request.action = 4; }), "action: 4 is not supported by this version");
  EXPECT_EQ(refusal([](Wire& w) {
              w.message.has_release = true;
              w.message.release = 2;
            }),
            "release: 2 is none of the 2 via points");
}

// What is quoted stays text, what is not stays a number; what has two meanings in YAML keeps its own.
TEST(Wire, ADocumentKeepsItsMeaningInOneLine) {
  for (const std::string value : {"1e-3", "-1", "+0.5", "\"1\"", "'it''s'", "\"a: b, c\"", "a-b", "|\n  two\n  lines",
                                  "[1, [2, {a: b}], ~]", "{}", "[]", "\"\\u00e9\\t\\\\\"", "yes", "{? k : v}"}) {
    const YamlNode before = YamlNode::parse("key: " + value + "\n", "before");
    const YamlNode after = YamlNode::parse(before.flow(), "after");
    EXPECT_EQ(after.flow(), before.flow()) << value;
    EXPECT_EQ(after.at("key").is_number(), before.at("key").is_number()) << value;
    if (before.at("key").is_scalar()) {
      EXPECT_EQ(after.at("key").text(), before.at("key").text()) << value;
    }
  }
}

// The client's file names are nobody else's.
TEST(Wire, ADocumentLeavesTheRobotOut) {
  EXPECT_EQ(without_robot("robot: my.yaml\n" + kShort, ""), without_robot(kShort, ""));
}

TEST(Wire, TermsOfAMotionRequestAreChecked) {
  const auto refusal = [](auto change) {
    fjr_msg_MotionRequest message = dds::encode(order_of(kShort));
    change(message);
    const Order order = dds::decode(message);
    return order.refusal ? order.refusal->field + ": " + order.refusal->sentence : "none";
  };
  using Message = fjr_msg_MotionRequest;
  EXPECT_EQ(refusal([](Message&) {}), "none");
  EXPECT_EQ(refusal([](Message& m) { m.start_within = kInfinity; }),
            "start_within: inf s must be finite and not negative");
  EXPECT_EQ(refusal([](Message& m) { m.budget = -1; }), "budget: -1 s must be finite and not negative");
  EXPECT_EQ(refusal([](Message& m) { m.action = 4; }), "action: 4 is not supported by this version");
}

TEST(Wire, ADocumentThatIsTooLongIsRefusedBeforeSending) {
  EXPECT_THROW((void)dds::encode(order_of(kShort + "name: " + std::string(65536, 'x') + "\n")), InputError);
}

TEST(Wire, WrongShapesAreRefusedBeforeSending) {
  EXPECT_THROW((void)dds::encode_plan_request(order_of("goal: {q: [1]}\n")), InputError);
  EXPECT_THROW((void)dds::encode_plan_request(order_of("start: {q: [0, 0]}\n")), InputError);
  EXPECT_THROW((void)dds::encode_plan_request(order_of(kShort + "sped: 1\n")), InputError);
  std::string vias = "via: [";
  for (int i = 0; i < 33; ++i) vias += "{q: [0, 0]}, ";
  EXPECT_THROW((void)dds::encode_plan_request(order_of(kShort + vias + "]\n")), InputError);
}

TEST(Wire, AReplyOfSolvedWithoutATrajectoryHasFailed) {
  Reply reply;
  reply.state = ReplyState::kSolved;
  for (const std::vector<Sample>& rows : {std::vector<Sample>{}, std::vector<Sample>{{.time = kNan}}}) {
    reply.rows = rows;
    const Reply received = dds::decode(dds::encode(reply));
    EXPECT_EQ(received.state, ReplyState::kFailed);
    EXPECT_EQ(received.why.reason, Reason::kNoTrajectory);
    EXPECT_TRUE(received.rows.empty());
  }
  reply.rows = {Sample{}};
  EXPECT_EQ(dds::decode(dds::encode(reply)).state, ReplyState::kSolved);
}

TEST(Wire, ReplyArrivesComplete) {
  Reply reply;
  reply.id.client[3] = 42;
  reply.state = ReplyState::kFailed;
  reply.why = {Reason::kUncertified, "goal", "a sentence"};
  reply.plan_json = "{}";
  reply.rows = {{0.0, {}, {1, 2}}, {0.5, {}, {3, 4}}};
  const Reply received = dds::decode(dds::encode(reply));
  EXPECT_EQ(received.id, reply.id);
  EXPECT_EQ(received.why.sentence, "a sentence");
  EXPECT_EQ(received.plan_json, "{}");
  ASSERT_EQ(received.rows.size(), 2u);
  EXPECT_EQ(received.rows[1].time, 0.5);
  EXPECT_EQ(received.rows[1].torque[1], 4);
}

TEST(Wire, WhatIsLearntFromAndWhatWasLearntComeAsTheyWent) {
  ExecutedRun run;
  run.robot_id = "left";
  run.robot_hash = "hash";
  run.trajectory_id = {new_client().client, 7};
  run.code = ResultCode::kPathToleranceViolated;
  run.sentence = "link 1 was off";
  run.missed_ticks = 3;
  for (int i = 0; i < 4; ++i) {
    const double t = 0.001 * i;
    run.rows.push_back({t, {t + 1, t + 2}, {t + 3, t + 4}, {t + 5, t + 6}, {t + 7, t + 8}, {t + 9, t + 10}});
  }
  const ExecutedRun came = dds::decode(dds::encode(run));
  EXPECT_EQ(came.robot_id, run.robot_id);
  EXPECT_EQ(came.robot_hash, run.robot_hash);
  EXPECT_EQ(came.trajectory_id, run.trajectory_id);
  EXPECT_EQ(came.code, run.code);
  EXPECT_EQ(came.sentence, run.sentence);
  EXPECT_EQ(came.missed_ticks, run.missed_ticks);
  EXPECT_EQ(as_payload(came.rows), as_payload(run.rows));

  TrajectoryOrder order;
  order.robot_id = "left";
  order.id = run.trajectory_id;
  order.epoch = 5;
  order.rows.resize(3);
  order.rows[1].torque = {1, 2};
  order.learnt = true;
  order.signature = {"value", "signer"};
  const TrajectoryOrder learnt = dds::decode(dds::encode_learnt(order)), planned = dds::decode(dds::encode_2(order));
  EXPECT_TRUE(learnt.learnt);
  EXPECT_FALSE(planned.learnt);
  EXPECT_EQ(learnt.signature.value, "value");
  EXPECT_EQ(signed_bytes(learnt), signed_bytes(order));
  EXPECT_NE(signed_bytes(planned), signed_bytes(order));  // neither passes for the other
}

TEST(Wire, TextIsCutBetweenCharacters) {
  char bounded[4];
  dds::set_text(bounded, "ab\xC3\xA9");  // the last character takes two bytes, one more than there is room for
  EXPECT_EQ(dds::text_of(bounded), "ab");
}

Job job_of(std::uint64_t number, int priority) {
  Job job;
  job.order.id.number = number;
  job.order.priority = priority;
  return job;
}

TEST(JobQueue, GoesByPriorityThenArrival) {
  JobQueue queue(4);
  for (const auto& [number, priority] : {std::pair{1, 0}, {2, 5}, {3, 0}, {4, 5}}) {
    EXPECT_FALSE(queue.full_for({}));
    queue.push(job_of(static_cast<std::uint64_t>(number), priority));
  }
  EXPECT_TRUE(queue.full_for({}));
  for (const std::uint64_t expected : {2, 4, 1, 3}) EXPECT_EQ(queue.pop().order.id.number, expected);
}

TEST(JobQueue, GivesEachParticipantItsTurn) {
  JobQueue queue(3);
  for (std::uint64_t i = 1; i <= 3; ++i) queue.push(job_of(i, 0));
  Job other = job_of(9, 0);
  other.order.origin[0] = 1;
  EXPECT_TRUE(queue.full_for({}));
  EXPECT_FALSE(queue.full_for(other.order.origin));
  queue.push(other);
  for (const std::uint64_t expected : {1, 9, 2, 3}) EXPECT_EQ(queue.pop().order.id.number, expected);
}

// Eight participants may use their share to the full.
TEST(JobQueue, HasRoomForWhoeverIsNew) {
  JobQueue queue(3);
  const auto fill = [&](std::uint8_t participant) {
    std::size_t room = 0;
    Job job = job_of(1, 0);
    job.order.origin[0] = participant;
    for (; !queue.full_for(job.order.origin); ++room) queue.push(job);
    return room;
  };
  for (std::uint8_t participant = 1; participant <= 8; ++participant) EXPECT_EQ(fill(participant), 3u);
  EXPECT_EQ(fill(9), 2u);
  EXPECT_EQ(fill(1), 0u);
  for (std::uint8_t participant = 10; participant < 40; ++participant) EXPECT_GE(fill(participant), 1u);
}

TEST(ReplyCache, RefusalsCostNoTrajectory) {
  ReplyCache cache(2, 1 << 20);
  Reply reply;
  reply.state = ReplyState::kSolved;
  cache.add(std::make_shared<const Reply>(reply));
  reply.state = ReplyState::kRejected;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    reply.id.number = i;
    cache.add(std::make_shared<const Reply>(reply));
  }
  EXPECT_NE(cache.find({}), nullptr);
  EXPECT_EQ(cache.size(), 3u);
}

TEST(ReplyCache, ForgetsTheOldestBeyondItsBounds) {
  ReplyCache cache(2, 1 << 20);
  std::vector<RequestId> ids(3);
  for (std::uint64_t i = 0; i < ids.size(); ++i) {
    ids[i].number = i;
    Reply reply;
    reply.id = ids[i];
    cache.add(std::make_shared<const Reply>(reply));
  }
  EXPECT_EQ(cache.find(ids[0]), nullptr);
  EXPECT_NE(cache.find(ids[1]), nullptr);
  EXPECT_NE(cache.find(ids[2]), nullptr);
}

// Each from a client of its own, whose names tell nothing of their age.
TEST(ReplyCache, OfManyWhoHaveOneEachTheOldestGoes) {
  ReplyCache cache(2, 1 << 20);
  std::vector<RequestId> ids(3);
  for (std::uint64_t i = 0; i < ids.size(); ++i) {
    ids[i].number = i;
    Reply reply;
    reply.id = ids[i];
    reply.origin = {static_cast<std::uint8_t>(9 - i)};
    cache.add(std::make_shared<const Reply>(reply));
  }
  EXPECT_EQ(cache.find(ids[0]), nullptr);
  EXPECT_NE(cache.find(ids[2]), nullptr);
}

TEST(ReplyCache, IsBoundedInBytes) {
  ReplyCache cache(1000, 1 << 20);
  for (std::uint64_t i = 0; i < 10; ++i) {
    Reply reply;
    reply.id.number = i;
    reply.rows.resize(4096);  // 360 kB
    cache.add(std::make_shared<const Reply>(reply));
  }
  EXPECT_EQ(cache.size(), 2u);
}

// ---- work of other machines ----

WorkResult solved() {
  WorkResult result;
  result.lease = {{1, 2}, 3, 4};
  result.worker = {5};
  result.outcome = WorkOutcome::kDone;
  result.state = ReplyState::kSolved;
  result.errors = {{0.1, 0.2}, {0.3, 0.4}};
  result.plan_json = "{\n  \"name\": \"reach\"\n}\n";
  result.rows.resize(2);
  result.rows[1].time = 0.5;
  result.rows[1].torque = {6, 7};
  result.stops.resize(1);
  result.stops[0].duration = 0.25;
  return result;
}

WorkResult over_the_wire(const WorkResult& result) { return dds::decode(dds::encode(result)); }

TEST(WorkWire, AResultComesAsItWent) {
  const WorkResult sent = solved(), got = over_the_wire(sent);
  EXPECT_EQ(got.lease, sent.lease);
  EXPECT_EQ(got.worker, sent.worker);
  EXPECT_EQ(got.outcome, WorkOutcome::kDone);
  EXPECT_EQ(got.state, ReplyState::kSolved);
  EXPECT_EQ(got.errors.certified, sent.errors.certified);
  EXPECT_EQ(got.errors.predicted, sent.errors.predicted);
  EXPECT_EQ(got.plan_json, sent.plan_json);
  ASSERT_EQ(got.rows.size(), 2u);
  EXPECT_EQ(got.rows[1].time, 0.5);
  EXPECT_EQ(got.rows[1].torque, sent.rows[1].torque);
  ASSERT_EQ(got.stops.size(), 1u);
  EXPECT_EQ(got.stops[0].duration, 0.25);
}

// Whoever wrote it: nobody is answered with it, and the service does not fall over it.
TEST(WorkWire, AResultThatCannotBeMeantCountsAsLost) {
  const auto becomes = [](auto change) {
    WorkResult result = solved();
    change(result);
    return over_the_wire(result);
  };
  const std::vector<std::function<void(WorkResult&)>> changes = {
      [](WorkResult& r) { r.rows.clear(); },
      [](WorkResult& r) { r.state = ReplyState::kFailed; },  // with rows
      [](WorkResult& r) { r.state = ReplyState::kAccepted; },
      [](WorkResult& r) { r.state = static_cast<ReplyState>(99); },
      [](WorkResult& r) { r.why.reason = static_cast<Reason>(99); },
      [](WorkResult& r) { r.outcome = static_cast<WorkOutcome>(99); },
      [](WorkResult& r) { r.rows[1].state.q[0] = kNan; },
      [](WorkResult& r) { r.rows[1].time = kInfinity; },
  };
  for (const auto& change : changes) {
    const WorkResult got = becomes(change);
    EXPECT_EQ(got.outcome, WorkOutcome::kLost);
    EXPECT_EQ(got.lease, solved().lease);
    EXPECT_TRUE(got.rows.empty());
  }
}

TEST(WorkWire, ALeaseAndAnOfferComeAsTheyWent) {
  LeaseWord word;
  word.lease = {{1}, 2, 3};
  word.kind = LeaseKind::kGranted;
  word.instance = "cell-1";
  word.id = {{9}, 8};
  word.name = "reach";
  word.executes = true;
  word.document = kShort;
  const LeaseWord got = dds::decode(dds::encode(word));
  EXPECT_EQ(got.lease, word.lease);
  EXPECT_EQ(got.kind, LeaseKind::kGranted);
  EXPECT_EQ(got.instance, "cell-1");
  EXPECT_EQ(got.id, word.id);
  EXPECT_EQ(got.name, "reach");
  EXPECT_TRUE(got.executes);
  EXPECT_EQ(got.document, kShort);

  WorkerOffer offer;
  offer.worker = {7};
  offer.slots = 3;
  offer.held = {{word.lease, {"solve", 12, 0.5, 1e-3}}};
  const dds::WireOffer wire = dds::encode(offer);
  const WorkerOffer heard = dds::decode(wire.message);
  EXPECT_EQ(heard.worker, offer.worker);
  EXPECT_EQ(heard.slots, 3u);
  ASSERT_EQ(heard.held.size(), 1u);
  EXPECT_EQ(heard.held[0].lease, word.lease);
  EXPECT_EQ(heard.held[0].progress.stage, "solve");
  EXPECT_EQ(heard.held[0].progress.iteration, 12);
}

}  // namespace
}  // namespace fjr
