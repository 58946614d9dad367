#include "planner/dds/discovery.h"

#include <fmt/format.h>

#include <algorithm>

namespace fjr::dds {
namespace {

constexpr std::size_t kMost = 64;
constexpr double kHandshake = 0.3;  // [s] on a machine where 31 participants meet on two cores

Entity builtin_reader(const Participant& participant, dds_entity_t topic) {
  return Entity(dds_create_reader(participant.handle(), topic, nullptr, nullptr), "built-in topic");
}

template <class Guid>
Discovery::Key key_of(const Guid& guid) {
  Discovery::Key key{};
  std::copy(std::begin(guid.v), std::end(guid.v), key.begin());
  return key;
}

Discovery::Key key_of(const Participant& participant) {
  dds_guid_t guid;
  checked(dds_get_guid(participant.handle(), &guid), "guid");
  return key_of(guid);
}

}  // namespace

Discovery::Discovery(const Participant& participant)
    : participants_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT)),
      readers_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)),
      writers_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION)),
      self_(key_of(participant)),
      secured_(participant.secured()) {}

// Calls use(sample, whether it is still there) for everything that is new.
template <class Sample, class Use>
void Discovery::take(const Entity& reader, Use use) {
  for (std::size_t count = kMost; count == kMost;) {
    std::array<void*, kMost> samples{};
    std::array<dds_sample_info_t, kMost> infos{};
    const dds_return_t taken = checked(dds_take(reader.handle(), samples.data(), infos.data(), kMost, kMost), "take");
    count = static_cast<std::size_t>(taken);
    for (std::size_t i = 0; i < count; ++i) {
      use(*static_cast<const Sample*>(samples[i]), infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE);
    }
    if (taken > 0) dds_return_loan(reader.handle(), samples.data(), taken);
  }
}

bool Discovery::look() {
  bool news = false;
  const auto note_endpoint = [&](std::set<std::string> Peer::*topics) {
    return [this, &news, topics](const dds_builtintopic_endpoint_t& endpoint, bool there) {
      const Key key = key_of(endpoint.participant_key);
      if (!there || key == self_) return;
      (peers_[key].*topics).insert(endpoint.topic_name);
      news = true;
    };
  };
  take<dds_builtintopic_endpoint_t>(readers_, note_endpoint(&Peer::reads));
  take<dds_builtintopic_endpoint_t>(writers_, note_endpoint(&Peer::writes));
  take<dds_builtintopic_participant_t>(participants_,
                                       [this, &news](const dds_builtintopic_participant_t& participant, bool there) {
                                         const Key key = key_of(participant.key);
                                         if (key == self_) return;
                                         if (!there) {
                                           peers_.erase(key);
                                         } else {
                                           news = peers_.try_emplace(key).second || news;
                                         }
                                       });
  return news;
}

std::size_t Discovery::strangers() const {
  return static_cast<std::size_t>(std::count_if(peers_.begin(), peers_.end(), [](const auto& peer) {
    return peer.second.reads.empty() && peer.second.writes.empty();
  }));
}

// DDS does not distinguish handshakes that are under way from failed ones.
double Discovery::handshakes_may_take() const { return secured_ ? kHandshake * static_cast<double>(strangers()) : 0; }

std::optional<std::string> Discovery::about_strangers() const {
  const std::size_t count = strangers();
  if (count == 0) return std::nullopt;
  const std::string there = fmt::format("{} other participant{} there and {} nothing be seen", count,
                                        count == 1 ? " is" : "s are", count == 1 ? "lets" : "let");
  if (!secured_) {
    return there + ": do they use DDS Security? This program does not, for FJR_SECURITY is not set";
  }
  return there +
         ": they have no credentials of the authorities of those that FJR_SECURITY names, or use no DDS Security";
}

}  // namespace fjr::dds
