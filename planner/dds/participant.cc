#include "planner/dds/participant.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>

#include "common/input_error.h"
#include "model/parameters.h"
#include "planner/dds/reach.h"
#include "planner/dds/steady_waits.h"

namespace fjr::dds {
namespace {

namespace fs = std::filesystem;

bool configured_by_user() {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  return uri != nullptr && *uri != '\0';
}

// Waits while another thread still deletes the domain with its last participant.
Entity loopback_domain(unsigned domain) {
  const fs::path file = default_robot_file().parent_path() / "cyclonedds.xml";
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "", "no such file; CYCLONEDDS_URI is not set");
  const std::string uri = "file://" + fs::absolute(file).string();
  dds_entity_t created = dds_create_domain(domain, uri.c_str());
  for (int i = 0; i < 1000 && created == DDS_RETCODE_PRECONDITION_NOT_MET; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    created = dds_create_domain(domain, uri.c_str());
  }
  return Entity(created, "domain");
}

// Returns the domain, which a process can configure only once and which must outlive all its participants.
std::shared_ptr<Entity> shared_domain(unsigned domain) {
  if (configured_by_user()) return nullptr;
  static std::mutex mutex;
  static std::map<unsigned, std::weak_ptr<Entity>> known;
  const std::lock_guard lock(mutex);
  std::shared_ptr<Entity> shared = known[domain].lock();
  if (!shared) known[domain] = shared = std::make_shared<Entity>(loopback_domain(domain));
  return shared;
}

Entity created(unsigned domain, const fs::path& credentials) {
  require_steady_waits();  // before credentials load plugins
  const Qos qos = credentials.empty() ? Qos() : with_credentials(credentials);
  const dds_entity_t participant = dds_create_participant(domain, qos.get(), nullptr);
  if (participant < 0 && !credentials.empty()) {
    throw InputError(credentials.string(), "", "not accepted by DDS Security, which says above why");
  }
  return Entity(participant, "participant");
}

}  // namespace

// The sockets that were open before DDS opens its own. One participant at a time opens them, so that none takes
// another's for those of the process.
struct Participant::Opening {
  static std::mutex& mutex() {
    static std::mutex one_at_a_time;
    return one_at_a_time;
  }
  std::unique_lock<std::mutex> alone{mutex()};
  std::set<std::string> sockets_before = open_sockets();
};

Participant::Participant(unsigned domain, const fs::path& credentials) : Participant(domain, credentials, Opening()) {}

Participant::Participant(unsigned domain, const fs::path& credentials, const Opening& opening)
    : secured_(!credentials.empty()), domain_(shared_domain(domain)), participant_(created(domain, credentials)) {
  note_opened_by_dds(opening.sockets_before, domain_ == nullptr);
  if (sends_only_over_loopback()) hear_only_loopback();
}

Participant guarded_participant(const Network& network) {
  Participant participant(network.domain, network.security);
  if (network.security.empty() && !network.allow_insecure_network && !sends_only_over_loopback()) {
    throw InputError(
        "CYCLONEDDS_URI", "",
        "DDS uses a network without DDS Security, and everybody on it could move the arm: give credentials "
        "(FJR_SECURITY, or `security` in service.yaml and executor.yaml; config/security/README.md), or accept it with "
        "--insecure-network (`allow_insecure_network: true` there)");
  }
  return participant;
}

}  // namespace fjr::dds
