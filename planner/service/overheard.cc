#include "planner/service/overheard.h"

#include "common/bounded_json.h"

namespace fjr {

void complete_overheard(Reply& reply) {
  reply.motion = reply.id;
  if (reply.rows.empty()) return;
  try {
    const auto plan = json_from_text<nlohmann::json>(reply.plan_json);
    const auto& request = plan.at("resolved_request");
    const auto& certificate = plan.at("certificate");
    const double tolerance = certificate.at("tolerance_rad").get<double>();
    reply.errors = {{tolerance, tolerance}, certificate.at("tracking").at("link_error_rad").get<Joints<double>>()};
    reply.rest_to_rest = request.at("start").at("at_rest").get<bool>() && request.at("goal").at("at_rest").get<bool>();
    const auto repetition = plan.find("repetition");
    if (repetition == plan.end()) return;
    reply.learnt = true;
    reply.motion = request_id_from(repetition->at("motion").get<std::string>()).value_or(reply.id);
    const auto& rehearsals = repetition->at("rehearsals");
    reply.errors.predicted =
        rehearsals.empty() ? Joints<double>{} : rehearsals.back().at("link_error_rad").get<Joints<double>>();
  } catch (const nlohmann::json::exception&) {
    reply.rest_to_rest = false;  // of another version, or not from a service
  }
}

}  // namespace fjr
