#include "planner/service/ownership.h"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include "planner/protocol/epoch.h"

namespace fjr {
namespace {

// Returns a hash that is the same on every machine: FNV-1a followed by the finaliser of SplitMix64, because FNV alone
// hardly mixes the last characters.
std::uint64_t rank(std::string_view robot, std::string_view instance) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::string_view part : {robot, std::string_view("\0", 1), instance}) {
    for (const char c : part) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
  return hash ^ (hash >> 31);
}

}  // namespace

Ownership::Ownership(std::string instance, std::string robot_id)
    : instance_(std::move(instance)), robot_id_(std::move(robot_id)) {}

void Ownership::heard(const std::string& instance, const std::string& robot_id, std::uint64_t epoch) {
  if (robot_id == robot_id_ && !believes(epoch)) return;
  peers_[instance] = {robot_id, epoch};
  if (robot_id == robot_id_) largest_ = std::max(largest_, epoch);
}

void Ownership::lost(const std::string& instance) { peers_.erase(instance); }

void Ownership::heard_executor(std::uint64_t epoch) {
  executor_ = epoch;
  largest_ = std::max(largest_, epoch);
}

bool Ownership::believes(std::uint64_t epoch) const { return epoch <= largest_believed(executor_); }

// Drops epochs that are no longer believed. That happens if another publisher claimed to be the executor before the
// real one was heard; the executor would refuse everything with such an epoch.
void Ownership::forget_what_is_not_believed() {
  if (believes(largest_)) return;
  if (!believes(epoch_)) epoch_ = 0;
  largest_ = std::max(executor_, epoch_);
  std::erase_if(peers_, [&](const auto& entry) { return !believes(entry.second.epoch); });
}

bool Ownership::outranked() const {
  const auto mine = std::tuple(epoch_, rank(robot_id_, instance_));
  return std::any_of(peers_.begin(), peers_.end(), [&](const auto& entry) {
    const auto& [name, peer] = entry;
    return peer.robot_id == robot_id_ && std::tuple(peer.epoch, rank(robot_id_, name)) > mine;
  });
}

bool Ownership::somebody_owns() const {
  return std::any_of(peers_.begin(), peers_.end(),
                     [&](const auto& entry) { return entry.second.robot_id == robot_id_ && entry.second.epoch > 0; });
}

bool Ownership::goes_before(const std::string& instance) const {
  return rank(robot_id_, instance_) >= rank(robot_id_, instance);
}

bool Ownership::first_in_line() const {
  return std::all_of(peers_.begin(), peers_.end(),
                     [&](const auto& entry) { return entry.second.robot_id != robot_id_ || goes_before(entry.first); });
}

bool Ownership::review() {
  const std::uint64_t before = epoch_;
  forget_what_is_not_believed();
  if (owner() && outranked()) epoch_ = 0;
  // An owner whose epoch is lower than the largest seen would be refused by the executor, so it takes a new one.
  const bool entitled = owner() ? epoch_ < largest_ : !somebody_owns() && first_in_line();
  if (entitled) epoch_ = largest_ = std::min(largest_, largest_believed(executor_) - 1) + 1;
  return epoch_ != before;
}

bool Ownership::has_standby() const {
  return std::any_of(peers_.begin(), peers_.end(),
                     [&](const auto& entry) { return entry.second.robot_id == robot_id_; });
}

bool Ownership::answers_for(const std::string& robot_id) const {
  if (robot_id == robot_id_) return owner();
  const std::set<std::string> served = robots();
  return owner() && !served.contains(robot_id) && *served.begin() == robot_id_;
}

std::set<std::string> Ownership::robots() const {
  std::set<std::string> served{robot_id_};
  for (const auto& [name, peer] : peers_) served.insert(peer.robot_id);
  return served;
}

}  // namespace fjr
