#include "planner/dds/lease_port.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "planner/dds/wire_work.h"

namespace fjr::dds {

LeasePort::Worker::Worker(const Participant& participant, const WorkerId& worker)
    : publisher(participant.publisher(client_name({worker, 0}))), leases(participant, publisher.handle()) {}

LeasePort::LeasePort(const Participant& participant, Waitset& waitset)
    : participant_(participant),
      offers_(participant, participant.handle()),
      results_(participant, participant.handle()) {
  waitset.attach(offers_.arrived());
  waitset.attach(results_.arrived());
}

// Deleting a writer waits up to 1 s for its readers. Those that have to wait are deleted concurrently.
LeasePort::~LeasePort() {
  std::vector<std::jthread> waiting;
  while (!workers_.empty()) forgotten_.push_back(workers_.extract(workers_.begin()));
  for (auto& worker : forgotten_) {
    if (!worker.mapped().leases.flush(0)) waiting.emplace_back([node = std::move(worker)]() mutable { node = {}; });
  }
}

std::vector<LeasePort::Offer> LeasePort::take_offers() {
  std::vector<Offer> offers;
  offers_.take_all([&](const fjr_msg_WorkerOffer& message, const dds_sample_info_t& info) {
    const bool alive = info.instance_state == DDS_IST_ALIVE;
    if (info.valid_data) offers.push_back({decode(message), alive});
    if (info.valid_data) return;
    offers.push_back({{}, alive});
    std::copy(std::begin(message.worker), std::end(message.worker), offers.back().offer.worker.begin());
  });
  return offers;
}

std::vector<WorkResult> LeasePort::take_results() {
  std::vector<WorkResult> results;
  results_.take_all([&](const fjr_msg_WorkResult& message, const dds_sample_info_t& info) {
    if (info.valid_data) results.push_back(decode(message));
  });
  return results;
}

void LeasePort::meet(const WorkerId& worker) { workers_.try_emplace(worker, participant_, worker); }

// Only a writer whose reader has received everything is deleted, because otherwise deleting waits for the reader.
void LeasePort::forget(const WorkerId& worker) {
  if (auto node = workers_.extract(worker)) forgotten_.push_back(std::move(node));
  std::erase_if(forgotten_, [](const auto& gone) { return gone.mapped().leases.flush(0); });
}

bool LeasePort::reachable(const WorkerId& worker) const {
  const auto found = workers_.find(worker);
  return found != workers_.end() && found->second.leases.has_reader();
}

bool LeasePort::send(const WorkerId& worker, const LeaseWord& word) {
  return reachable(worker) && workers_.at(worker).leases.write(encode(word));
}

void LeasePort::flush(std::chrono::nanoseconds timeout) const {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (const auto& [id, worker] : workers_) {
    const std::chrono::nanoseconds left = end - std::chrono::steady_clock::now();
    if (left.count() <= 0 || !worker.leases.flush(left.count())) return;
  }
}

}  // namespace fjr::dds
