#include "planner/service/repetition_frame.h"

#include <nlohmann/json.hpp>

#include "common/bounded_json.h"
#include "planner/service/cbor_items.h"

namespace fjr {

using Json = nlohmann::json;

std::string to_payload(const RunOfMotion& run) {
  const Json frame = {{"motion", run.motion},
                      {"run", run.run},
                      {"plan_json", run.plan_json},
                      {"rows", cbor_of(run.rows)},
                      {"ticks", cbor_of(run.ticks)},
                      {"missed_ticks", run.missed_ticks},
                      {"refused_fraction", run.refused_fraction ? Json(*run.refused_fraction) : Json(nullptr)}};
  const std::vector<std::uint8_t> bytes = Json::to_cbor(frame);
  return {bytes.begin(), bytes.end()};
}

RunOfMotion run_of_motion_from(std::string_view payload) {
  const Json frame = json_from_cbor<Json>(payload);
  RunOfMotion run;
  frame.at("motion").get_to(run.motion);
  frame.at("run").get_to(run.run);
  frame.at("plan_json").get_to(run.plan_json);
  run.rows = items_in<Sample>(frame.at("rows"));
  run.ticks = items_in<ExecutedRow>(frame.at("ticks"));
  frame.at("missed_ticks").get_to(run.missed_ticks);
  if (const Json& fraction = frame.at("refused_fraction"); !fraction.is_null())
    run.refused_fraction = fraction.get<double>();
  return run;
}

}  // namespace fjr
