#include "model/identify/robot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "common/atomic_file.h"
#include "common/strict_yaml.h"

namespace fjr {
namespace {

std::string joined(const std::set<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ", ")); }

std::string log_text(const Estimate& e) {
  const std::string name = std::filesystem::path(e.log).filename().string();
  return e.hash.empty() ? name : fmt::format("{} sha256 {}", name, e.hash);
}

// YAML's double quotes know backslashes.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c >= ' ' ? c : ' ';
  }
  return result + "\"";
}

std::string error_text(const std::optional<double>& error) { return error ? fmt::format("{:.6g}", *error) : "null"; }

struct Entry {
  Joints<double> value;
  std::string about, unit, source;
  Joints<std::optional<double>> error;
};

std::string format_entry(const std::string& name, const Entry& e) {
  const bool known = e.error[0] || e.error[1];
  const std::string errors = known ? fmt::format("[{}, {}]", error_text(e.error[0]), error_text(e.error[1])) : "null";
  return fmt::format("  {}: {{value: [{}, {}],{} unit: \"{}\", source: {}, standard_error: {}}}\n", name, e.value[0],
                     e.value[1], e.about, e.unit, quoted(e.source), errors);
}

Joints<std::optional<double>> errors_in(const YamlNode& entry) {
  const YamlNode node = entry.at("standard_error");
  Joints<std::optional<double>> errors;
  if (node.is_null()) return errors;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const YamlNode item = node.items()[j];
    if (!item.is_null()) errors[j] = item.number("1");
  }
  return errors;
}

// Writes the entries of the base file, replaced by the identified values.
class Writer {
 public:
  Writer(const Identified& identified, const std::filesystem::path& base, bool use_damping)
      : identified_(identified), base_(YamlNode::load(base)), use_damping_(use_damping) {
    // Inertias are about the points of Parameters here, whichever the base file has them about.
    const Parameters before = load_parameters(base);
    visit_parameters(before, [&](const std::string& section, const std::string& name, auto,
                                 const Joints<double>& value) { values_before_[section + "." + name] = value; });
  }

  std::string write() {
    std::string section_before;
    text_ = "# Written by `fjr identify`. SI units; motor quantities are in link coordinates; [joint 1, joint 2].\n";
    visit_parameters(identified_.robot, [&](const std::string& section, const std::string& name,
                                            const std::string& unit, const Joints<double>& value) {
      if (section != section_before) text_ += "\n" + section + ":\n";
      section_before = section;
      if (may_be_left_out(section, name) && !base_.at(section).find(name)) return;
      Entry entry{value, "", unit, "", {}};
      if (section == "link" && name == "inertia") entry.about = " about: [joint, center_of_mass],";
      const YamlNode old = base_.at(section).at(name);
      fill(section + "." + name, old, entry);
      if (section == "link" && name == "damping") fill_damping(old, entry);
      text_ += format_entry(name, entry);
    });
    write_payload();
    write_mounting();
    write_covariance();
    return text_;
  }

 private:
  std::optional<Eigen::Index> row_of(const std::string& name) const {
    const auto found = std::find(identified_.names.begin(), identified_.names.end(), name);
    if (found == identified_.names.end()) return std::nullopt;
    return found - identified_.names.begin();
  }

  void fill(const std::string& path, const YamlNode& old, Entry& entry) const {
    const Joints<std::optional<double>> old_errors = errors_in(old);
    std::set<std::string> logs;
    std::string kept;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::string name = fmt::format("{}[{}]", path, j);
      const auto row = row_of(name);
      const auto from = identified_.from.find(name);
      entry.error[j] = row ? std::sqrt(identified_.covariance(*row, *row)) : old_errors[j];
      if (row && from != identified_.from.end()) {
        for (const Estimate* e : from->second) logs.insert(log_text(*e));
        continue;
      }
      const bool same = values_before_.at(path)[j] == entry.value[j];
      const std::string before = "(" + old.at("source").text() + ")";
      kept += fmt::format("{}joint {} {}", kept.empty() ? "" : "; ", j + 1,
                          row    ? "kept, as its logs hardly tell it " + before
                          : same ? "assumed as before " + before
                                 : "only bounded by its log: the bound");
    }
    if (!logs.empty()) {
      entry.source = "identified: " + joined(logs) + (kept.empty() ? "" : "; " + kept);
    } else {
      const bool untouched = values_before_.at(path) == entry.value;
      entry.source = untouched ? old.at("source").text() : kept;
    }
  }

  void fill_damping(const YamlNode& old, Entry& entry) const {
    const Joints<bool>& has = identified_.has_damping;
    if (!has[0] && !has[1]) return;
    std::string found;
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!has[j]) continue;
      found += fmt::format("{}joint {}: {:.6g} +- {:.2g}", found.empty() ? "" : ", ", j + 1, identified_.damping[j],
                           identified_.damping_error[j]);
      if (!use_damping_) continue;
      entry.value[j] = std::max(identified_.damping[j], 0.0);
      entry.error[j] = identified_.damping_error[j];
    }
    entry.source = use_damping_ ? "identified: free decay, eqs. (11), (13); " + found
                                : fmt::format("{}; identified but not used: {}", old.at("source").text(), found);
  }

  void write_payload() {
    const Payload& payload = identified_.robot.payload;
    if (payload == Payload{} && payload.mass_error == 0 && payload.inertia_error == 0) return;
    text_ += "\n# What is fixed to the tip.\npayload:\n";
    write_payload_value("mass", payload.mass, payload.mass_error, kPayloadMassBound.unit);
    write_payload_value("inertia", payload.inertia, payload.inertia_error, kPayloadInertiaBound.unit);
  }

  void write_payload_value(const std::string& name, double value, double error, const std::string& unit) {
    std::set<std::string> logs;
    const auto from = identified_.from.find("payload." + name);
    if (from != identified_.from.end()) {
      for (const Estimate* e : from->second) logs.insert(log_text(*e));
    }
    text_ += fmt::format("  {}: {{value: {}, unit: \"{}\", source: {}, standard_error: {}}}\n", name, value, unit,
                         quoted(logs.empty() ? "as before" : "identified: " + joined(logs)),
                         error_text(error > 0 ? std::optional(error) : std::nullopt));
  }

  void write_mounting() {
    const PlaneMounting& mounting = identified_.robot.mounting;
    if (mounting == PlaneMounting{}) return;
    text_ += fmt::format("\nmounting: {{inclination: {}, down: {}}}\n", mounting.inclination, mounting.down);
  }

  void write_covariance() {
    std::string blocks;
    for (const std::vector<Eigen::Index>& block : correlated_blocks()) {
      if (block.size() < 2) continue;  // its standard error says it all
      blocks += "  - names: [";
      for (const Eigen::Index i : block) {
        blocks +=
            fmt::format("{}\"{}\"", i == block.front() ? "" : ", ", identified_.names[static_cast<std::size_t>(i)]);
      }
      blocks += "]\n    matrix:\n";
      for (const Eigen::Index row : block) {
        blocks += "      - [";
        for (const Eigen::Index column : block) {
          // Rounding must not make it unsymmetric.
          const double value = identified_.covariance(std::max(row, column), std::min(row, column));
          blocks += fmt::format("{}{:.10g}", column == block.front() ? "" : ", ", value);
        }
        blocks += "]\n";
      }
    }
    if (blocks.empty()) return;
    text_ +=
        "\n# What one experiment tells of several parameters it tells with errors that go together.\ncovariance:\n" +
        blocks;
  }

  // Returns the blocks of parameters that are correlated directly or through others, in the order of the names.
  std::vector<std::vector<Eigen::Index>> correlated_blocks() const {
    const Eigen::Index size = identified_.covariance.rows();
    std::vector<std::vector<Eigen::Index>> blocks;
    std::vector<bool> taken(static_cast<std::size_t>(size), false);
    for (Eigen::Index first = 0; first < size; ++first) {
      if (taken[static_cast<std::size_t>(first)]) continue;
      std::vector<Eigen::Index> block{first};
      taken[static_cast<std::size_t>(first)] = true;
      for (std::size_t next = 0; next < block.size(); ++next) {
        for (Eigen::Index other = 0; other < size; ++other) {
          if (taken[static_cast<std::size_t>(other)] || identified_.covariance(block[next], other) == 0) continue;
          taken[static_cast<std::size_t>(other)] = true;
          block.push_back(other);
        }
      }
      std::sort(block.begin(), block.end());
      blocks.push_back(std::move(block));
    }
    return blocks;
  }

  const Identified& identified_;
  YamlNode base_;
  std::map<std::string, Joints<double>> values_before_;
  bool use_damping_;
  std::string text_;
};

}  // namespace

std::string format_robot(const Identified& identified, const std::filesystem::path& base, bool use_damping) {
  return Writer(identified, base, use_damping).write();
}

Parameters write_robot_file(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path trial = file.string() + ".refused";
  write_file(trial, text);
  Parameters written = load_parameters(trial);
  std::filesystem::rename(trial, file);
  return written;
}

}  // namespace fjr
