#include "planner/service/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace fjr {
namespace {

constexpr std::array kExecutorModes{ExecutorMode::kResting,  ExecutorMode::kPreparing, ExecutorMode::kExecuting,
                                    ExecutorMode::kStopping, ExecutorMode::kHolding,   ExecutorMode::kStopped};

// Returns a label value as the text format of Prometheus writes it: quoted, with backslashes, quotes and ends of lines
// escaped.
std::string label_value(std::string_view label) {
  std::string text = "\"";
  for (const char c : label) {
    if (c == '\n') {
      text += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') text += '\\';
    text += c;
  }
  return text + "\"";
}

class Page {
 public:
  // Sets labels that all samples from now on begin with.
  void label_all(std::string labels) { common_ = std::move(labels); }

  // Begins a metric, to which the samples after this call belong. If several services have it, their samples stand
  // together, because the format allows every metric only once.
  void family(std::string_view name, std::string_view type, std::string_view help) {
    const auto is_it = [&](const Family& family) { return family.name == name; };
    family_ = static_cast<std::size_t>(std::ranges::find_if(families_, is_it) - families_.begin());
    if (family_ < families_.size()) return;
    families_.push_back({name, fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help)});
  }
  void sample(double value, std::string_view labels = "", std::string_view suffix = "") {
    Family& family = families_[family_];
    const std::string all = fmt::format("{}{}{}", common_, common_.empty() || labels.empty() ? "" : ",", labels);
    family.text += fmt::format("{}{}{} {}\n", family.name, suffix, all.empty() ? "" : "{" + all + "}", value);
  }
  void gauge(std::string_view name, double value, std::string_view help) {
    family(name, "gauge", help);
    sample(value);
  }
  void counter(std::string_view name, std::uint64_t value, std::string_view help) {
    family(name, "counter", help);
    sample(static_cast<double>(value));
  }
  void histogram(std::string_view name, const Histogram& histogram, std::string_view help) {
    family(name, "histogram", help);
    for (std::size_t i = 0; i < Histogram::kBounds.size(); ++i) {
      sample(static_cast<double>(histogram.at_most(i)), fmt::format("le=\"{}\"", Histogram::kBounds[i]), "_bucket");
    }
    sample(static_cast<double>(histogram.count()), "le=\"+Inf\"", "_bucket");
    sample(histogram.sum(), "", "_sum");
    sample(static_cast<double>(histogram.count()), "", "_count");
  }
  std::string text() const {
    std::string all;
    for (const Family& family : families_) all += family.text;
    return all;
  }

 private:
  struct Family {
    std::string_view name;
    std::string text;
  };
  std::string common_;
  std::vector<Family> families_;
  std::size_t family_ = 0;  // of the samples that follow
};

double since_1970(Metrics::Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

void add_requests(Page& page, const Metrics& metrics) {
  const ServiceStatus& s = metrics.status;
  page.counter("fjr_requests_received_total", s.received, "Requests that were looked at, each id once.");
  page.counter("fjr_requests_repeated_total", s.duplicates, "Requests whose id was in hand or remembered.");
  page.family("fjr_replies_total", "counter", "Final replies by outcome and reason, each id once.");
  for (const auto& [outcome, count] : metrics.tally.outcomes()) {
    const auto labels = fmt::format("state=\"{}\",reason=\"{}\"", name(outcome.first), name(outcome.second));
    page.sample(static_cast<double>(count), labels);
  }
  page.counter("fjr_certificates_refused_total", metrics.tally.uncertified(),
               "Motions that were planned and not certified, so that nobody got them.");
  page.histogram("fjr_solve_seconds", metrics.tally.solving(), "From the start of solving to the reply.");
  page.histogram("fjr_wait_seconds", metrics.tally.waiting(), "From the arrival of a request to the start of solving.");
  page.gauge("fjr_remembered_replies", static_cast<double>(metrics.remembered), "Replies that are given again.");
}

void add_resources(Page& page, const Metrics& metrics) {
  const ServiceStatus& s = metrics.status;
  page.gauge("fjr_queue_length", s.queued, "Requests that wait to be solved.");
  page.gauge("fjr_queue_capacity", s.queue_capacity, "Requests of one participant that may wait.");
  page.gauge("fjr_slots", s.workers, "Requests that can be solved at a time.");
  page.gauge("fjr_slots_busy", s.solving, "Requests that are being solved.");
  page.counter("fjr_workers_lost_total", s.workers_lost, "Solving processes that ended unexpectedly.");
  page.gauge("fjr_memory_bytes", static_cast<double>(s.memory), "Resident memory, solving processes included.");
}

void add_instance(Page& page, const Metrics& metrics) {
  const ServiceStatus& s = metrics.status;
  page.gauge("fjr_owner", s.epoch > 0 ? 1 : 0, "Whether this instance answers for its robot; 0: it is a standby.");
  page.gauge("fjr_epoch", static_cast<double>(s.epoch), "Number of this owner; 0 of a standby.");
  page.gauge("fjr_uptime_seconds", s.uptime, "Since the start of this instance.");
  page.gauge("fjr_snapshot_timestamp_seconds", since_1970(metrics.now),
             "When these numbers were taken: a service that hangs does not renew them.");
}

void add_executor(Page& page, const std::optional<ExecutorState>& executor) {
  page.gauge("fjr_executor_up", executor ? 1 : 0, "Whether the robot's executor is heard.");
  page.gauge("fjr_executor_epoch", executor ? static_cast<double>(executor->epoch) : 0,
             "Largest epoch that the executor has run.");
  page.family("fjr_executor_mode", "gauge", "1 for what the executor is doing; 0 everywhere when it is not heard.");
  for (const ExecutorMode mode : kExecutorModes) {
    page.sample(executor && executor->mode == mode ? 1 : 0, fmt::format("mode=\"{}\"", name(mode)));
  }
}

// Adds who the service is. This names the robot itself, so that it does without the labels of other samples.
void add_identity(Page& page, const ServiceStatus& s) {
  page.label_all("");
  page.family("fjr_info", "gauge", "Who it is; always 1.");
  page.sample(1, fmt::format("name={},robot_id={},robot_hash={},version={}", label_value(s.instance),
                             label_value(s.robot_id), label_value(s.robot_hash), label_value(s.version)));
}

}  // namespace

std::string metrics_text(const std::vector<std::optional<Metrics>>& services) {
  Page page;
  for (const std::optional<Metrics>& metrics : services) {
    if (!metrics) continue;
    page.label_all(services.size() > 1 ? "robot_id=" + label_value(metrics->status.robot_id) : "");
    add_requests(page, *metrics);
    add_resources(page, *metrics);
    add_instance(page, *metrics);
    add_executor(page, metrics->executor);
    add_identity(page, metrics->status);
  }
  return page.text();
}

}  // namespace fjr
