#include <fmt/format.h>

#include "common/normal.h"
#include "model/encoder.h"
#include "model/rig/record.h"

namespace fjr {
namespace {

// The number of streams of random numbers; each instrument has its own, so that its noise does not depend on the
// others.
constexpr std::uint64_t kStreams = 16;
Normal stream(const Rig& rig, std::uint64_t number) { return Normal(rig.seed * kStreams + number); }

class Encoder {
 public:
  Encoder(double counts, bool exact, double zero) : counts_(counts), exact_(exact), zero_(zero * count_angle(counts)) {}
  double read(double angle) const { return exact_ ? angle : quantised(angle + zero_, counts_) + 0.0; }  // no -0

 private:
  double counts_;
  bool exact_;
  double zero_;
};

std::vector<double>& add_column(Log& log, const std::string& name, std::size_t rows) {
  log.names.push_back(name);
  log.values.emplace_back().reserve(rows);
  return log.values.back();
}

template <class Read>
void add_joint_columns(Log& log, const Record& record, const char* quantity, Read&& read) {
  for (int j = 0; j < kJoints; ++j) {
    std::vector<double>& column = add_column(log, joint_column(quantity, j), record.time.size());
    for (std::size_t row = 0; row < record.time.size(); ++row) column.push_back(read(static_cast<std::size_t>(j), row));
  }
}

}  // namespace

Log measure(const Record& record, const Rig& rig) {
  const bool exact = !rig.instruments.encoders;
  Normal zeros = stream(rig, 0), torque_noise = stream(rig, 1), velocity_noise = stream(rig, 2);
  Joints<Encoder> link{Encoder(rig.truth.encoder.link_counts[0], exact, zeros.uniform() - 0.5),
                       Encoder(rig.truth.encoder.link_counts[1], exact, zeros.uniform() - 0.5)};
  Joints<Encoder> motor{Encoder(rig.truth.encoder.motor_counts[0], exact, zeros.uniform() - 0.5),
                        Encoder(rig.truth.encoder.motor_counts[1], exact, zeros.uniform() - 0.5)};
  Log log;
  log.source = "virtual rig";
  log.metadata = record.metadata;
  log.metadata["seed"] = fmt::format("{}", rig.seed);
  add_column(log, "time", 0) = record.time;
  add_joint_columns(log, record, "q",
                    [&](std::size_t j, std::size_t row) { return link[j].read(record.states[row].q[j]); });
  add_joint_columns(log, record, "theta",
                    [&](std::size_t j, std::size_t row) { return motor[j].read(record.states[row].theta[j]); });
  add_joint_columns(log, record, "tau", [&](std::size_t j, std::size_t row) {
    return record.torques[row][j] + rig.instruments.torque_noise[j] * torque_noise();
  });
  if (record.log_velocity) {
    add_joint_columns(log, record, "dtheta", [&](std::size_t j, std::size_t row) {
      if (!record.drive_velocity.empty()) return record.drive_velocity[row][j];
      return record.states[row].dtheta[j] + rig.instruments.velocity_noise[j] * velocity_noise();
    });
  }
  for (const auto& [name, values] : record.planned) add_column(log, name, 0) = values;
  return log;
}

}  // namespace fjr
