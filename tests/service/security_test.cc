// DDS Security as config/security sets it up: who may take part does, nobody else; and no network without it.
#include <gmock/gmock.h>

#include "planner/dds/reader.h"
#include "planner/dds/wire_execution.h"
#include "planner/dds/writer.h"
#include "planner/protocol/signature.h"
#include "tests/executor/flat_motion.h"
#include "tests/support/service_processes.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class SecurityTest : public ServiceProcesses {
 protected:
  void SetUp() override {
    ServiceProcesses::SetUp();
    make_credentials("ours");
  }

  void make_credentials(const std::string& folder) {
    Process script({FJR_SOURCE_DIR "/config/security/make_credentials.sh", path(folder).string()}, path("make.log"));
    ASSERT_EQ(script.wait(), 0) << script.output();
  }
  std::string credentials(const std::string& name) const { return path("ours") / name; }
  std::unique_ptr<Process> guest(const std::string& log, const std::string& environment) const {
    return std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", environment, FJR_GUEST, std::to_string(domain_), "3"}, path(log));
  }
  std::vector<std::string> as(const std::string& name) const { return {"FJR_SECURITY=" + credentials(name)}; }
};

TEST_F(SecurityTest, PlansAndExecutesForThoseWhoMay) {
  const auto service = serve({}, as("service"));
  const auto executor =
      fjr({"executor", "--start", "0.3,0.2", "--state", path("state")}, "executor.log", as("executor"));
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
  const auto request = fjr({"request", path("quick.yaml"), "--execute"}, "request.log", as("client"));
  EXPECT_EQ(request->wait(), 0) << request->output();
  EXPECT_THAT(request->output(), HasSubstr("execution   code 0"));
}

TEST_F(SecurityTest, RepeatsForThoseWhoMay) {
  write("loop.yaml",
        "start: {q: [0, 0]}\nvia: [{q: [0.3, -0.2]}]\ngoal: {q: [0, 0]}\nduration: 0.8\nobjective: gentle\nsearch: "
        "quick\n");
  const auto service = serve({}, as("service"));
  const auto executor = fjr({"executor", "--state", path("state"), "--fast"}, "executor.log", as("executor"));
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
  const auto planned =
      fjr({"request", path("loop.yaml"), "--execute", "--out", path("a")}, "request.log", as("client"));
  EXPECT_EQ(planned->wait(), 0) << planned->output();
  const auto repeated = fjr({"request", path("a"), "--repeat"}, "repeat.log", as("client"));
  EXPECT_EQ(repeated->wait(), 0) << repeated->output() << executor->output();
  EXPECT_THAT(repeated->output(), AllOf(HasSubstr("repetition  2"), HasSubstr("execution   code 0")));
}

// A guest without credentials, one with those of other authorities, and one with our authority's identity who wrote and
// signed permissions himself.
TEST_F(SecurityTest, IgnoresEverybodyElse) {
  make_credentials("theirs");
  fs::copy(credentials("executor"), path("impostor"));
  Process forge({"/bin/sh", "-ec",
                 "sed s/OU=client,CN=client/OU=executor,CN=executor/ ours/client/permissions.xml > forged.xml;"
                 "openssl smime -sign -text -in forged.xml -out impostor/permissions.p7s"
                 " -signer theirs/authority/permissions_ca.cert.pem -inkey theirs/authority/permissions_ca.key.pem;"
                 "cp theirs/authority/governance.p7s theirs/authority/permissions_ca.cert.pem impostor"},
                path("forge.log"), path(""));
  ASSERT_EQ(forge.wait(), 0) << forge.output();

  const auto service = serve({}, as("service"));
  const auto unknown = guest("unknown.log", "FJR_SECURITY=");
  const auto foreign = guest("foreign.log", "FJR_SECURITY=" + (path("theirs") / "client").string());
  const auto impostor = guest("impostor.log", "FJR_SECURITY=" + path("impostor").string());
  const auto welcome = guest("welcome.log", as("client")[0]);
  for (const auto& refused : {&unknown, &foreign, &impostor}) {
    EXPECT_EQ((*refused)->wait(), 0);
    EXPECT_THAT((*refused)->output(), HasSubstr("matched=0 heard=0 replies=0"));
  }
  EXPECT_EQ(welcome->wait(), 0);
  EXPECT_THAT(welcome->output(), ContainsRegex("matched=1 heard=[1-9][0-9]* replies=2"));
  const auto status = fjr({"status", "--json"}, "status.log", as("client"));
  EXPECT_EQ(status->wait(), 0);
  EXPECT_THAT(status->output(), HasSubstr("\"received\": 1,"));
  EXPECT_THAT(status->output(), HasSubstr("\"solved\": 1,"));
}

TEST_F(SecurityTest, HoldsEverybodyToTheirRole) {
  const auto observer = guest("observer.log", as("observer")[0]);
  EXPECT_NE(observer->wait(), 0);
  EXPECT_THAT(observer->output(), HasSubstr("Not Allowed By Security"));
  const dds::Participant client(domain_, credentials("client"));
  EXPECT_THROW(dds::Writer<fjr_msg_Trajectory>(client, client.handle()), dds::Error);
  EXPECT_THROW(dds::Reader<fjr_msg_PlanRequest>(client, client.handle()), dds::Error);
  EXPECT_NO_THROW(dds::Writer<fjr_msg_PlanRequest>(client, client.handle()));
}

TEST_F(SecurityTest, HoldsAndStopsForThoseWhoMay) {
  make_credentials("theirs");
  const auto executor = fjr({"executor", "--state", path("state")}, "executor.log", as("executor"));
  ASSERT_TRUE(comes_true([&] { return executor->output().find("executing for") != std::string::npos; }));
  const auto halt = [&](const std::string& command, const std::vector<std::string>& environment) {
    const auto program = fjr({command, "--find", "1.5"}, "halt.log", environment);
    const int code = program->wait();
    return std::to_string(code) + " " + program->output();
  };
  const std::string unknown = halt("stop", {"FJR_SECURITY="});
  EXPECT_THAT(unknown, AllOf(StartsWith("1 "), HasSubstr("fjr: stop could not be sent")));  // after what DDS says
  EXPECT_THAT(unknown, HasSubstr("FJR_SECURITY is not set"));
  const std::string foreign = halt("stop", {"FJR_SECURITY=" + (path("theirs") / "client").string()});
  EXPECT_THAT(foreign, AllOf(StartsWith("1 "), HasSubstr("fjr: stop could not be sent")));  // after what DDS says
  EXPECT_THAT(foreign, HasSubstr("no credentials of the authorities"));
  const std::string observer = halt("stop", as("observer"));
  EXPECT_THAT(observer, HasSubstr("Not Allowed By Security"));
  EXPECT_THAT(executor->output(), Not(HasSubstr("commanded")));
  EXPECT_THAT(halt("hold", as("client")), HasSubstr("0 arm: holding at"));
  EXPECT_THAT(executor->output(), HasSubstr("hold commanded"));
  EXPECT_THAT(halt("stop", as("client")), HasSubstr("0 arm: stopped until"));
}

TEST_F(SecurityTest, LeasesWorkToThoseWhoMay) {
  const auto service = serve({"--workers", "0"}, as("service"));
  const auto guest = fjr({"serve", "--worker-only"}, "guest.log", as("client"));
  EXPECT_NE(guest->wait(), 0);
  EXPECT_THAT(guest->output(), HasSubstr("Not Allowed By Security"));
  const auto worker = fjr({"serve", "--worker-only"}, "worker.log", as("worker"));
  const auto request = fjr({"request", path("quick.yaml"), "--out", path("out")}, "request.log", as("client"));
  EXPECT_EQ(request->wait(), 0) << request->output();
  EXPECT_THAT(worker->output(), HasSubstr("leased by="));
}

// Everybody shakes hands with everybody: 31 participants, 465 times. Nobody gives up while that goes on.
TEST_F(SecurityTest, ServesManyClientsThatComeAtOnce) {
  const auto service = serve({}, as("service"));
  constexpr int kClients = 30;
  std::vector<std::unique_ptr<Process>> clients;
  for (int i = 0; i < kClients; ++i) {
    clients.push_back(
        fjr({"request", path("bad.yaml"), "--silence", "60"}, "client" + std::to_string(i), as("client")));
  }
  for (const auto& client : clients) EXPECT_EQ(client->wait(), 2) << client->output();
}

TEST_F(SecurityTest, SaysWhyAServiceIsNotFound) {
  const auto service = serve({}, as("service"));
  const auto status = fjr({"status", "--json"}, "status.log", as("observer"));
  EXPECT_EQ(status->wait(), 0) << status->output();
  EXPECT_THAT(status->output(), HasSubstr("\"epoch\": 1"));
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"status"}, {"request", path("bad.yaml"), "--find", "1"}}) {
    const auto unknown = fjr(words, "unknown.log", {"FJR_SECURITY="});
    EXPECT_EQ(unknown->wait(), 1);
    EXPECT_THAT(unknown->output(), HasSubstr("1 other participant is there and lets nothing be seen"));
    EXPECT_THAT(unknown->output(), HasSubstr("FJR_SECURITY is not set"));
  }
}

TEST_F(SecurityTest, NamesCredentialsThatAreNoGood) {
  fs::remove(path("ours") / "service" / "key.pem");
  const auto incomplete = fjr({"serve"}, "incomplete.log", as("service"));
  EXPECT_EQ(incomplete->wait(), 2);
  EXPECT_THAT(incomplete->output(), HasSubstr("service/key.pem: no such file; DDS Security needs it"));
  write("ours/client/permissions.p7s", "nobody signed this");
  const auto unsigned_permissions = fjr({"status"}, "unsigned.log", as("client"));
  EXPECT_EQ(unsigned_permissions->wait(), 2);
  EXPECT_THAT(unsigned_permissions->output(), HasSubstr("ours/client: not accepted by DDS Security"));
}

// At the start, and not when the first trajectory is planned: no executor would run what is signed by these.
TEST_F(SecurityTest, DoesNotServeWhatNoExecutorWouldRun) {
  const auto outcome = [&](const std::string& change) {
    fs::remove_all(path("other"));
    fs::copy(credentials("service"), path("other"));
    const std::string sign =
        " openssl req -new -sha256 -key other/key.pem -subj /O=fjr/OU=service/CN=service | openssl x509 -req -days 2"
        " -CA ours/authority/identity_ca.cert.pem -CAkey ours/authority/identity_ca.key.pem -set_serial 7"
        " -out other/cert.pem";
    Process script({"/bin/sh", "-ec", "sign() {" + sign + " \"$@\"; };" + change}, path("change.log"), path(""));
    EXPECT_EQ(script.wait(), 0) << script.output();
    Process service({"/usr/bin/timeout", "5", "/usr/bin/env", "FJR_SECURITY=" + path("other").string(), FJR_EXECUTABLE,
                     "serve", "--domain", std::to_string(domain_)},
                    path("serve.log"));
    EXPECT_EQ(service.wait(), 2);
    return service.output();
  };
  EXPECT_THAT(outcome("cp ours/client/*.pem other"),
              HasSubstr("other/cert.pem: its role (OU) is \"client\"; trajectories are signed as \"service\""));
  EXPECT_THAT(outcome("cp ours/executor/key.pem other"), HasSubstr("other/key.pem: is not the key of cert.pem"));
  EXPECT_THAT(outcome("openssl genpkey -algorithm ed25519 -out other/key.pem; sign"),
              HasSubstr("other/key.pem: is a key for ED25519; EC and RSA are allowed"));
  EXPECT_THAT(outcome("openssl genrsa -out other/key.pem 1024; sign"),
              HasSubstr("other/key.pem: has 80 bits of security, at least 112 are needed"));
  EXPECT_THAT(outcome("{ printf nsComment=; head -c 9000 /dev/zero | tr '\\0' x; } > long; sign -extfile long"),
              ContainsRegex("other/cert.pem: has 9[0-9]* bytes, at most 8192 are allowed"));
  EXPECT_THAT(outcome("openssl req -x509 -newkey "
                      "rsa:2048 -nodes -keyout other/key.pem -out other/cert.pem -subj /OU=service/CN=self 2> err"),
              HasSubstr("other/cert.pem: signed by \"self\", for whom the identity authority does not vouch"));
}

// Whatever DDS lets through, the executor runs what the service has signed, as it has signed it.
TEST_F(SecurityTest, RunsOnlyWhatTheServiceHasSigned) {
  make_credentials("theirs");
  const auto executor = fjr({"executor", "--start", "0,0", "--state", path("state")}, "executor.log", as("executor"));
  const Parameters robot = load_parameters(default_robot_file());
  const dds::Participant participant(domain_, credentials("service"));
  dds::Reader<fjr_msg_ExecutionResult> results(participant, participant.handle());
  std::optional<dds::Writer<fjr_msg_Trajectory2>> trajectories_2;
  dds::Writer<fjr_msg_Trajectory> trajectories(participant, participant.handle());
  TrajectoryOrder order;
  order.robot_id = "arm";
  order.id = new_client();
  order.epoch = 3;
  order.robot_hash = robot_hash(robot);
  order.certified = order.ends_at_rest = true;
  order.rows = flat_motion(robot, {0, 0}, {0.2, 0}, 0.5).samples;
  const auto result_of = [&](auto change, const fs::path& signer) {
    ++order.id.number;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    order.published = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    TrajectoryOrder sent = order;
    if (!signer.empty()) sent.signature = Signer(signer, signer.filename().string()).sign(signed_bytes(sent));
    change(sent);
    EXPECT_TRUE(trajectories_2 ? trajectories_2->write(dds::encode_2(sent)) : trajectories.write(dds::encode(sent)));
    std::optional<ExecutionResult> result;
    EXPECT_TRUE(comes_true([&] {
      results.take_all([&](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
        if (info.valid_data && dds::decode(message).trajectory_id == sent.id) result = dds::decode(message);
      });
      return result.has_value();
    }));
    return result.value_or(ExecutionResult{}).sentence;
  };
  const fs::path service = credentials("service");
  const auto as_it_is = [](TrajectoryOrder&) {};
  ASSERT_TRUE(comes_true([&] { return trajectories.has_reader(); }));
  EXPECT_THAT(result_of(as_it_is, service), HasSubstr("not signed"));  // where there is no place for it
  trajectories_2.emplace(participant, participant.handle());
  ASSERT_TRUE(comes_true([&] { return trajectories_2->has_reader(); }));
  EXPECT_THAT(result_of(as_it_is, {}), HasSubstr("not signed"));
  EXPECT_THAT(result_of(as_it_is, credentials("client")),
              HasSubstr("signed by \"client\", whose role is \"client\" and not \"service\""));
  EXPECT_THAT(result_of(as_it_is, path("theirs") / "service"), HasSubstr("the identity authority does not vouch"));
  const std::string altered = "altered after \"service\" signed it";
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { o.rows[250].torque[0] += 1e-9; }, service), HasSubstr(altered));
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { o.rows.resize(250); }, service), HasSubstr(altered));
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { ++o.epoch; }, service), HasSubstr(altered));
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { ++o.id.number; }, service), HasSubstr(altered));
  ++order.id.number;  // which that one had
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { o.tolerances.path = {0.5, 0.5}; }, service), HasSubstr(altered));
  EXPECT_THAT(result_of([](TrajectoryOrder& o) { o.published += 1; }, service), HasSubstr(altered));
  EXPECT_EQ(result_of(as_it_is, service), "");

  // A copy of what runs does not disturb it, nor is there a result for it, whether it comes after it or before it.
  const auto says = [&](const std::string& what) { return executor->output().find(what) != std::string::npos; };
  for (const bool copied_first : {false, true}) {
    order.rows = copied_first ? flat_motion(robot, {0, 0}, {0.2, 0}, 1.0).samples
                              : flat_motion(robot, {0.2, 0}, {0, 0}, 1.0).samples;
    ++order.id.number;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    order.published = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    order.signature = Signer(service).sign(signed_bytes(order));
    TrajectoryOrder copy = order;
    copy.rows[500].torque[0] += 1e-9;
    if (copied_first) {
      EXPECT_TRUE(trajectories_2->write(dds::encode_2(copy)));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_TRUE(trajectories_2->write(dds::encode_2(order)));
    ASSERT_TRUE(comes_true([&] { return says("executing id=" + text(order.id)); }));
    if (!copied_first) {
      EXPECT_TRUE(trajectories_2->write(dds::encode_2(copy)));
    }
    std::vector<ExecutionResult> of_copied;
    (void)comes_true(
        [&] {
          results.take_all([&](const fjr_msg_ExecutionResult& message, const dds_sample_info_t& info) {
            if (!info.valid_data || dds::decode(message).trajectory_id != order.id) return;
            of_copied.push_back(dds::decode(message));
          });
          return false;
        },
        3);
    ASSERT_EQ(of_copied.size(), 1U) << copied_first;
    EXPECT_EQ(of_copied[0].code, ResultCode::kSuccessful) << of_copied[0].sentence;
    EXPECT_TRUE(says("left out a copy of id=" + text(order.id) + ": altered after")) << executor->output();
  }
  EXPECT_THAT(executor->output(), HasSubstr("code=0"));
}

// In a namespace with an interface that is not the loopback one.
TEST_F(SecurityTest, DoesNotServeANetworkUnprotectedUnlessToldTo) {
  const std::string network =
      "ip link set lo up && ip link add fjr0 type veth peer name fjr1 && ip addr add 10.99.0.1/24 dev fjr0 &&"
      " ip link set fjr0 up && ip link set fjr1 up || exit 99; " FJR_EXECUTABLE " serve --config " +
      path("service.yaml").string();
  const auto serving = [&](const std::string& environment, const std::string& configuration) {
    write("service.yaml", configuration);
    return in_network_namespace(environment + "; export CYCLONEDDS_URI FJR_INTERFACE FJR_SECURITY; " + network +
                                "& service=$!; while ! grep -q serving serve.log && kill -0 $service; do sleep 0.05; "
                                "done; kill $service; wait $service");
  };
  if (serving("", "{}").empty()) GTEST_SKIP() << "network namespaces are not allowed here";
  const std::string lab = "FJR_INTERFACE=fjr0; CYCLONEDDS_URI=file://" FJR_SOURCE_DIR "/config/cyclonedds-lab.xml";
  const std::string inline_xml =
      "CYCLONEDDS_URI='file://" FJR_SOURCE_DIR
      "/config/cyclonedds.xml,"
      "<General><Interfaces><NetworkInterface address=\"10.99.0.1\"/></Interfaces></General>'";
  const auto outcome = [&](const std::string& environment, const std::string& configuration) {
    Process service(serving(environment, configuration), path("serve.log"), path(""));
    const int code = service.wait();
    return std::to_string(code) + " " + service.output();
  };
  for (const std::string& unprotected : {lab, inline_xml, std::string("CYCLONEDDS_URI='<Tracing/>'")}) {
    const std::string text = outcome(unprotected, "{workers: 1}");
    EXPECT_EQ(text.substr(0, 2), "2 ") << text;
    EXPECT_THAT(text, HasSubstr("DDS uses a network without DDS Security"));
    EXPECT_THAT(text, Not(HasSubstr("serving")));
  }
  const std::string ours = (path("ours") / "service").string();
  for (const auto& [environment, configuration] : std::vector<std::pair<std::string, std::string>>{
           {lab, "{allow_insecure_network: true}"},
           {lab, "{security: ours/service}"},
           {lab + " FJR_SECURITY=" + ours, "{workers: 1}"},
           {"CYCLONEDDS_URI='<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces></General>'", "{}"},
           {"CYCLONEDDS_URI=", "{}"}}) {
    const std::string text = outcome(environment, configuration);
    EXPECT_EQ(text.substr(0, 2), "0 ") << text;
    EXPECT_THAT(text, HasSubstr("serving"));
  }
}

// Whoever could have the arm moved or stopped by others, or would move or stop somebody's: all in one namespace.
TEST_F(SecurityTest, NoProgramUsesANetworkUnprotectedUnlessToldTo) {
  const std::string lab =
      "export FJR_INTERFACE=fjr0 CYCLONEDDS_URI=file://" FJR_SOURCE_DIR "/config/cyclonedds-lab.xml;";
  const std::string network =
      "ip link set lo up && ip link add fjr0 type veth peer name fjr1 && ip addr add 10.99.0.1/24 dev fjr0 &&"
      " ip link set fjr0 up && ip link set fjr1 up || exit 99; tell() { timeout 20 \"$@\"; echo \"$2: $?\"; };";
  write("executor.yaml", "allow_insecure_network: true\n");
  const auto script =
      in_network_namespace(lab + network +
                           "fjr=" FJR_EXECUTABLE
                           ";for what in executor hold stop 'request quick.yaml';"
                           "do tell $fjr $what --domain 1; done;"
                           "tell $fjr hold --insecure-network --domain 1;"
                           "$fjr executor --config executor.yaml --state state --domain 1 & executor=$!;"
                           "tell $fjr hold --insecure-network --domain 1; kill $executor; wait $executor");
  if (script.empty()) GTEST_SKIP() << "network namespaces are not allowed here";
  Process programs(script, path("programs.log"), path(""));
  EXPECT_EQ(programs.wait(), 0);
  const std::string log = programs.output();
  for (const std::string program : {"executor", "hold", "stop", "request"}) {
    EXPECT_THAT(log, ContainsRegex("DDS uses a network without DDS Security.* accept it with --insecure-network.*\n" +
                                   program + ": 2\n"));
  }
  EXPECT_THAT(log, HasSubstr("no executor reports for robot 'arm'"));
  EXPECT_THAT(log, HasSubstr("arm: holding at"));
}

// Two machines: a program on the other one publishes a trajectory as soon as somebody here would take it.
TEST_F(SecurityTest, AForgedTrajectoryFromAnotherMachineMeetsNobody) {
  const std::string lab = "export CYCLONEDDS_URI=file://" FJR_SOURCE_DIR "/config/cyclonedds-lab.xml;";
  const std::string two_machines =
      "unshare -n sleep 60 & other=$!; there() { nsenter -t $other -n env FJR_INTERFACE=fjr1 \"$@\"; };"
      "while [ $(readlink /proc/$other/ns/net) = $(readlink /proc/self/ns/net) ]; do sleep 0.02; done;"
      "{ ip link set lo up && ip link add fjr0 type veth peer name fjr1 && ip link set fjr1 netns $other &&"
      " ip addr add 10.99.0.1/24 dev fjr0 && ip link set fjr0 up && there ip link set lo up &&"
      " there ip addr add 10.99.0.2/24 dev fjr1 && there ip link set fjr1 up; } || exit 99;";
  const auto moved = [&](const std::string& options) {
    return in_network_namespace(
        lab + two_machines +
        "there " FJR_FORGER " 1 4 > forger.log & forger=$!; FJR_INTERFACE=fjr0 " FJR_EXECUTABLE
        " executor --domain 1 --state state " +
        options + "& executor=$!; wait $forger; kill $executor; wait $executor; echo ended: $?; kill $other");
  };
  if (moved("").empty()) GTEST_SKIP() << "network namespaces are not allowed here";
  Process unprotected(moved(""), path("unprotected.log"), path(""));
  EXPECT_EQ(unprotected.wait(), 0);
  EXPECT_THAT(unprotected.output(), HasSubstr("ended: 2"));
  EXPECT_EQ(contents(path("forger.log")), "matched=0 moved=0.000\n");
  Process told_to(moved("--insecure-network"), path("told.log"), path(""));  // the network does carry it
  EXPECT_EQ(told_to.wait(), 0);
  EXPECT_THAT(told_to.output(), HasSubstr("ended: 0"));
  EXPECT_THAT(contents(path("forger.log")), HasSubstr("matched=1"));
}

}  // namespace
}  // namespace fjr
