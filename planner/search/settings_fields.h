// The settings of the search by their keys: reading, writing, checking and plan.json go by this list. A setting's key
// is the name of its member. A member that is left out here does not compile (settings_file.cc).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>

#include "planner/search/settings.h"

namespace fjr {

struct SettingKey {
  const char* name;
  const char* unit = "1";
  // What is allowed; of a list, for each of its values. The bounds keep the search from what it cannot do: from
  // dividing by zero, looping for ever, or meshes of any size. Whether a value is of use is another question.
  double least = 0, most = 0;
};

template <class S, class Group>
concept SettingsOf = std::same_as<std::remove_const_t<S>, Group>;

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

constexpr SettingKey iterations_key(const char* name) { return {name, "1", 1, 10000}; }
constexpr SettingKey fraction_key(const char* name) { return {name, "1", 0, 1}; }

// visit_fields(settings, visit) calls visit(key, member) for each member; a group's own members are visited by
// visit_fields() of the member. S is a group of settings, const or not.

// ---- continuation ----

template <SettingsOf<FirstSolveSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"interval", "s", 1e-3, 1}, s.interval);
  visit({"interval_among_obstacles", "s", 1e-3, 1}, s.interval_among_obstacles);
  visit({"most_among_obstacles", "1", 0, 2500}, s.most_among_obstacles);
  visit({"interval_without_hurry", "s", 1e-3, 1}, s.interval_without_hurry);
  visit({"most_without_hurry", "1", 0, 2500}, s.most_without_hurry);
  visit({"fewest_intervals", "1", 2, 2500}, s.fewest_intervals);
  visit({"most_intervals", "1", 2, 2500}, s.most_intervals);
  visit({"intervals_per_via", "1", 0, 100}, s.intervals_per_via);
  visit({"same_minimum", "1", 0, 0.1}, s.same_minimum);
  visit({"hopeless", "1", 1, 1000}, s.hopeless);
  visit({"iteration_factor_when_ahead", "1", 1, 10}, s.iteration_factor_when_ahead);
  visit(fraction_key("small_violation"), s.small_violation);
}

template <SettingsOf<WarmStartSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(iterations_key("iterations"), s.iterations);
  visit({"barrier", "1", 1e-11, 0.1}, s.barrier);
  visit(iterations_key("iterations_to_another_price"), s.iterations_to_another_price);
  visit(fraction_key("worthwhile_decrease"), s.worthwhile_decrease);
  visit(iterations_key("more_iterations"), s.more_iterations);
}

template <SettingsOf<HomotopySettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"mesh_tolerance", "rad", 1e-9, 0.01}, s.mesh_tolerance);
  visit(iterations_key("iterations"), s.iterations);
  visit(iterations_key("iterations_of_shift"), s.iterations_of_shift);
  visit(iterations_key("iterations_with_reward"), s.iterations_with_reward);
  visit(iterations_key("iterations_with_rests"), s.iterations_with_rests);
  visit({"rest_width", "rad/s", 0, 0.1}, s.rest_width);
  visit({"halvings", "1", 0, 6}, s.halvings);
  visit({"sharp_width", "rad/s", 1e-6, 0.1}, s.sharp_width);
}

template <SettingsOf<NodeTimeSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(iterations_key("iterations"), s.iterations);
  visit({"first_width", "rad/s", 0, 0.1}, s.first_width);
  visit({"rounds", "1", 1, 20}, s.rounds);
}

template <SettingsOf<RegularisationSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(fraction_key("largest"), s.largest);
  visit({"decrease", "1", 0.01, 1}, s.decrease);
  visit({"largest_change", "1", 1e-6, 1}, s.largest_change);
  visit({"rounds", "1", 0, 20}, s.rounds);
}

template <SettingsOf<MeshSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"tolerance", "rad", 1e-9, 0.01}, s.tolerance);
  visit({"full_tolerance_from", "s", 0.01, 10}, s.full_tolerance_from);
  visit({"least_part_of_tolerance", "1", 1e-4, 1}, s.least_part_of_tolerance);
  visit({"shortest_interval", "s", 1e-5, 0.1}, s.shortest_interval);
  visit({"shortest_interval_for_peak", "s", 1e-5, 0.1}, s.shortest_interval_for_peak);
  visit({"most_intervals", "1", 10, 10000}, s.most_intervals);
  visit({"rows_without_task", "1", 1, 1000}, s.rows_without_task);
  visit({"looser", "1", 1.1, 10}, s.looser);
  visit({"cost_tolerance", "1", 1e-9, 1}, s.cost_tolerance);
  visit({"excess_worth_splitting", "1", 1e-6, 10}, s.excess_worth_splitting);
  visit({"excess_worth_quartering", "1", 1, 1000}, s.excess_worth_quartering);
  visit({"error_when_splitting", "1", 1.01, 100}, s.error_when_splitting);
  visit(fraction_key("others_of_sum"), s.others_of_sum);
}

template <SettingsOf<TighteningSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"rounds", "1", 1, 50}, s.rounds);
  visit({"round_tolerance", "1", 1e-10, 0.01}, s.round_tolerance);
  visit({"round_violation", "1", 1e-12, 1e-3}, s.round_violation);
  visit({"failures", "1", 1, 20}, s.failures);
  visit({"rounds_of_whole_margin", "1", 0, 50}, s.rounds_of_whole_margin);
  visit(fraction_key("later_part_of_margin"), s.later_part_of_margin);
  visit({"growth", "1", 1, 100}, s.growth);
  visit({"ineffective_growth", "1", 1, 100}, s.ineffective_growth);
  visit({"sharp_for_peaks", "rad/s", 0, 0.1}, s.sharp_for_peaks);
  visit({"rounds_of_splitting_for_peak", "1", 0, 50}, s.rounds_of_splitting_for_peak);
  visit({"creep_rounds", "1", 0, 50}, s.creep_rounds);
}

template <SettingsOf<CreepSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"probes", "1", 1, 1000}, s.probes);
  visit({"shortest_rest", "s", 0, 100}, s.shortest_rest);
  visit({"faster", "1", 1, 10}, s.faster);
}

template <SettingsOf<ContinuationSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"first"}, s.first);
  visit({"warm"}, s.warm);
  visit({"homotopy"}, s.homotopy);
  visit({"nodes"}, s.nodes);
  visit({"regularisation"}, s.regularisation);
  visit({"mesh"}, s.mesh);
  visit({"tightening"}, s.tightening);
  visit({"creep"}, s.creep);
}

// ---- starts ----

template <SettingsOf<StartSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"thorough", "1", 1, 10}, s.thorough);
  visit({"waiting", "1", 0, 0.9}, s.waiting);
  visit({"further", "1", 0, 100}, s.further);
  visit({"longest_passing", "1", 1, 1000}, s.longest_passing);
  visit(fraction_key("throwing_speed"), s.throwing_speed);
  visit({"far_away", "rad", 0, 3}, s.far_away);
  visit({"for_neighbour", "1", 1, 100}, s.for_neighbour);
  visit({"most_paths", "1", 1, 20}, s.most_paths);
  visit({"more_among_obstacles", "1", 0, 100}, s.more_among_obstacles);
  visit({"near_the_best_among_obstacles", "1", 0, 100}, s.near_the_best_among_obstacles);
  visit({"another_end", "rad", 0, 10}, s.another_end);
  visit({"end_by_distance", "1/rad", 0, 100}, s.end_by_distance);
}

template <SettingsOf<StartOrderSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"at_a_time", "1", 1, 100}, s.at_a_time);
  visit({"near_by", "rad", 0, 3}, s.near_by);
  visit({"given_up", "1", 1, 100}, s.given_up);
  visit({"before_swinging", "1", 0, 100}, s.before_swinging);
  visit({"before_fastest", "1", 0, 100}, s.before_fastest);
  visit({"before_sketching_fastest", "1", 0, 100}, s.before_sketching_fastest);
  visit({"little_time", "1", 0, 10}, s.little_time);
}

template <SettingsOf<FollowSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(iterations_key("iterations"), s.iterations);
  visit(iterations_key("least_iterations"), s.least_iterations);
  visit({"slower", "1", 1, 100}, s.slower);
  visit({"within", "1", 0, 10}, s.within);
  visit({"within_with_friction", "1", 0, 10}, s.within_with_friction);
  visit({"most", "1", 1, 100}, s.most);
  visit({"most_with_friction", "1", 1, 100}, s.most_with_friction);
  visit({"long_motion", "s", 0, 1000}, s.long_motion);
  visit({"far_too_long", "1", 1, 100}, s.far_too_long);
  visit({"barrier_after_bounds", "1", 1e-11, 0.1}, s.barrier_after_bounds);
}

template <SettingsOf<RaceSettings::Gap> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"width", "rad/s", 0, 1}, s.width);
  visit({"distance", "1", 0, kUnbounded}, s.distance);
}

template <SettingsOf<RaceSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"same_minimum", "1", 0, 0.1}, s.same_minimum);
  visit({"gaps"}, s.gaps);
  visit({"last_gap", "1", 0, kUnbounded}, s.last_gap);
  visit({"gap_without_friction", "1", 0, kUnbounded}, s.gap_without_friction);
}

// ---- fallbacks ----

template <SettingsOf<FallbackSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(iterations_key("iterations"), s.iterations);
  visit(iterations_key("patient_iterations"), s.patient_iterations);
  visit({"patient_regularisation", "1", 0.01, 1000}, s.patient_regularisation);
  visit({"patient_starts", "1", 0, 100}, s.patient_starts);
  visit({"coarser", "1", 0.1, 1}, s.coarser);
  visit({"finer", "1", 1, 4}, s.finer);
  visit({"relaxed", "1", 0.01, 100}, s.relaxed);
}

template <SettingsOf<StepwiseSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(iterations_key("iterations"), s.iterations);
  visit({"longest_interval", "s", 1e-3, 1}, s.longest_interval);
  visit({"first_step", "1", 1e-5, 1}, s.first_step);
  visit({"longer_step", "1", 1, 10}, s.longer_step);
  visit({"growth", "1", 1e-4, 1}, s.growth);
  visit({"shortest_step", "1", 1e-5, 1}, s.shortest_step);
  visit({"most_patience", "1", 1, 100}, s.most_patience);
  visit({"sharp_width_factor", "1", 1e-4, 1}, s.sharp_width_factor);
  visit({"sharpest_width_factor", "1", 1e-4, 1}, s.sharpest_width_factor);
}

template <SettingsOf<SwingUpSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"easily_carried", "1", 1.001, 10}, s.easily_carried);
  visit(fraction_key("winding_up"), s.winding_up);
  visit({"much_too_heavy", "1", 1, 10}, s.much_too_heavy);
  visit({"durations", "1", 0.1, 20}, s.durations);
  visit({"swing", "1", 0.05, 10}, s.swing);
  visit({"mesh_factor", "1", 0.1, 4}, s.mesh_factor);
  visit({"hopeless_slack", "1", 0, 10}, s.hopeless_slack);
  visit(fraction_key("negligible_slack"), s.negligible_slack);
  visit(fraction_key("reported_deficit"), s.reported_deficit);
  visit(iterations_key("iterations"), s.iterations);
  visit({"shortenings", "1", 0, 20}, s.shortenings);
  visit(iterations_key("shortening_iterations"), s.shortening_iterations);
  visit(iterations_key("last_iterations"), s.last_iterations);
  visit({"patience", "1", 1, 100}, s.patience);
}

template <SettingsOf<SpareTimeSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"one_motion", "s", 0.1, 100}, s.one_motion);
  visit({"two_motions", "s", 0.1, 100}, s.two_motions);
  visit({"times_usual", "1", 1, 100}, s.times_usual);
  visit({"worthwhile", "1", 1.01, 1000}, s.worthwhile);
  visit({"accelerations_from", "s", 0, 200}, s.accelerations_from);
  visit({"pause", "s", 0.01, 10}, s.pause);
  visit({"speed", "rad/s", 1e-6, 0.1}, s.speed);
  visit({"hardly_moving", "rad/s", 1e-6, 1}, s.hardly_moving);
  visit({"costly_wait", "1", 1, 10}, s.costly_wait);
  visit({"intervals_at_end", "1", 1, 1000}, s.intervals_at_end);
  visit({"intervals_of_pause", "1", 1, 1000}, s.intervals_of_pause);
  visit(iterations_key("iterations"), s.iterations);
  visit({"barrier_at_end", "1", 1e-11, 10}, s.barrier_at_end);
  visit({"barrier_of_pause", "1", 1e-11, 10}, s.barrier_of_pause);
  visit({"width_at_end", "rad/s", 0, 1}, s.width_at_end);
  visit({"width_of_pause", "rad/s", 0, 1}, s.width_of_pause);
}

template <SettingsOf<FastestSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"hardly_more", "1", 1, 100}, s.hardly_more);
}

template <SettingsOf<AccelerationPenaltySettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"time_to_oscillate", "s", 0, 1000}, s.time_to_oscillate);
  visit({"weight", "s^4/rad^2", 0, 1}, s.weight);
  visit({"less", "1", 0.01, 0.99}, s.less);
  visit({"steps", "1", 0, 50}, s.steps);
  visit({"part_of_objective", "1", 0, 10}, s.part_of_objective);
  visit({"damping_factor", "1", 0.001, 0.99}, s.damping_factor);
  visit({"fastest_acceleration", "s^4/rad^2", 0, 10}, s.fastest_acceleration);
  visit({"fastest_jerk", "s^6/rad^2", 0, 10}, s.fastest_jerk);
  visit({"less_jerk", "1", 1, 1e6}, s.less_jerk);
}

// ---- refining ----

template <SettingsOf<PublicationSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"rounds", "1", 1, 8}, s.rounds);
  visit({"finer_rows", "1", 0.1, 1}, s.finer_rows);
  visit({"rounds_by_accuracy", "1", 0, 100}, s.rounds_by_accuracy);
  visit({"shorter_rests", "1", 0.01, 1}, s.shorter_rests);
}

template <SettingsOf<TrackingSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"worthwhile", "1", 1e-6, 1}, s.worthwhile);
  visit({"stalled", "1", 1, 20}, s.stalled);
  visit({"first_stiffness", "1", 1e-6, 1e6}, s.first_stiffness);
  visit({"least_stiffness", "1", 1e-6, 1e6}, s.least_stiffness);
  visit({"most_stiffness", "1", 1e-6, 1e6}, s.most_stiffness);
  visit({"softer", "1", 1, 100}, s.softer);
  visit({"stiffer", "1", 1, 100}, s.stiffer);
  visit(fraction_key("trusted"), s.trusted);
  visit(fraction_key("distrusted"), s.distrusted);
  visit({"least_variance", "rad^2", 1e-10, 1}, s.least_variance);
}

template <SettingsOf<RobustSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"fitting_rounds", "1", 0, 20}, s.fitting_rounds);
  visit({"wider", "1", 1, 10}, s.wider);
  visit({"pieces", "1", 1, 5000}, s.pieces);
  visit({"patience", "1", 1, 100}, s.patience);
}

// ---- explanations ----

template <SettingsOf<SlackSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"most", "1", 0.01, 1000}, s.most);
  visit({"loose", "1", 0, 100}, s.loose);
  visit({"time_weight", "1/s", 1e-6, 10}, s.time_weight);
  visit({"larger_time_weight", "1/s", 1e-6, 10}, s.larger_time_weight);
  visit({"longer", "1", 1, 100}, s.longer);
}

template <SettingsOf<OutOfReachSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(fraction_key("clearly_early"), s.clearly_early);
  visit({"clearly_more", "1", 0, 100}, s.clearly_more);
  visit(fraction_key("clearly_slower"), s.clearly_slower);
  visit({"much_faster", "1", 1, 100}, s.much_faster);
}

template <SettingsOf<ExplanationSolveSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"budget", "s", 0, 1000}, s.budget);
  visit(iterations_key("iterations"), s.iterations);
  visit(iterations_key("iterations_of_slack"), s.iterations_of_slack);
  visit(iterations_key("iterations_from_fastest"), s.iterations_from_fastest);
  visit({"longest_on_full_mesh", "s", 0.01, 1000}, s.longest_on_full_mesh);
  visit({"exceeded", "1", 0, 100}, s.exceeded);
  visit({"guesses", "1", 1, 20}, s.guesses);
}

template <SettingsOf<ExplanationSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"solves"}, s.solves);
  visit({"candidates", "1", 1, 100}, s.candidates);
  visit({"candidates_at_a_time", "1", 1, 100}, s.candidates_at_a_time);
  visit(fraction_key("in_the_way"), s.in_the_way);
  visit({"time_to_carry", "1", 1, 100}, s.time_to_carry);
  visit(fraction_key("margin"), s.margin);
  visit(fraction_key("rough_margin"), s.rough_margin);
  visit(fraction_key("combined_margin"), s.combined_margin);
  visit({"duration_margin", "1", 0, 0.1}, s.duration_margin);
  visit(fraction_key("spare_time"), s.spare_time);
  visit({"retries", "1", 1, 100}, s.retries);
  visit({"trials", "1", 1e-4, 10}, s.trials);
  visit({"slack_worth_exact_friction", "1", 0, 10}, s.slack_worth_exact_friction);
  visit(fraction_key("negligible_slack"), s.negligible_slack);
  visit({"slack_beyond_single_limits", "1", 0, 100}, s.slack_beyond_single_limits);
  visit({"large_change", "1", 0, 100}, s.large_change);
  visit({"barred_margin", "1", 1, 10}, s.barred_margin);
  visit({"widths", "1", 1, 10}, s.widths);
  visit({"time_tolerance", "1", 1e-4, 1}, s.time_tolerance);
  visit({"no_change", "1", 1e-6, 1}, s.no_change);
  visit({"more_rows", "1", 0, 10000}, s.more_rows);
}

// ---- all ----

template <SettingsOf<BudgetSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit(fraction_key("finding"), s.finding);
  visit(fraction_key("refining"), s.refining);
  visit({"fallbacks", "1", 0, 10}, s.fallbacks);
  visit({"damping", "1", 1, 10}, s.damping);
}

template <SettingsOf<SearchSettings> S, class Visit>
constexpr void visit_fields(S& s, Visit&& visit) {
  visit({"continuation"}, s.continuation);
  visit({"starts"}, s.starts);
  visit({"order"}, s.order);
  visit({"follow"}, s.follow);
  visit({"race"}, s.race);
  visit({"fallbacks"}, s.fallbacks);
  visit({"stepwise"}, s.stepwise);
  visit({"swing_up"}, s.swing_up);
  visit({"spare_time"}, s.spare_time);
  visit({"fastest"}, s.fastest);
  visit({"acceleration_penalty"}, s.acceleration_penalty);
  visit({"publication"}, s.publication);
  visit({"tracking"}, s.tracking);
  visit({"robust"}, s.robust);
  visit({"slack"}, s.slack);
  visit({"out_of_reach"}, s.out_of_reach);
  visit({"explanation"}, s.explanation);
  visit({"budget"}, s.budget);
}

// ---- walking through all of them ----

template <class T>
concept SettingNumber = std::is_arithmetic_v<std::remove_const_t<T>>;

template <class T>
concept SettingList = requires(T& list) {
  list.size();
};

// Calls visit(path, key, member) for every number and every list of numbers below a group. path: "race.gaps[0].width".
template <class Group, class Visit>
void visit_settings_below(Group& group, const std::string& above, const Visit& visit) {
  visit_fields(group, [&](const SettingKey& key, auto& member) {
    using Member = std::remove_reference_t<decltype(member)>;
    const std::string path = above.empty() ? key.name : above + "." + key.name;
    if constexpr (SettingNumber<Member>) {
      visit(path, key, member);
    } else if constexpr (!SettingList<Member>) {
      visit_settings_below(member, path, visit);
    } else if constexpr (SettingNumber<typename Member::value_type>) {
      visit(path, key, member);
    } else {
      for (std::size_t i = 0; i < member.size(); ++i) {
        visit_settings_below(member[i], path + "[" + std::to_string(i) + "]", visit);
      }
    }
  });
}

template <SettingsOf<SearchSettings> S, class Visit>
void visit_all_settings(S& settings, const Visit& visit) {
  visit_settings_below(settings, "", visit);
}

}  // namespace fjr
