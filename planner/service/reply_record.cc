#include "planner/service/reply_record.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/bounded_json.h"
#include "planner/service/cbor_items.h"

namespace fjr {
namespace {

using Json = nlohmann::json;

}  // namespace

std::string to_record(const Reply& reply) {
  const Json record = {{"client", reply.id.client},
                       {"number", reply.id.number},
                       {"state", reply.state},
                       {"reason", reply.why.reason},
                       {"field", reply.why.field},
                       {"sentence", reply.why.sentence},
                       {"robot_id", reply.robot_id},
                       {"robot_hash", reply.robot_hash},
                       {"request_hash", reply.request_hash},
                       {"version", reply.version},
                       {"solve_time", reply.solve_time},
                       {"wait_time", reply.wait_time},
                       {"plan_json", reply.plan_json},
                       {"certified_error", reply.errors.certified},
                       {"predicted_error", reply.errors.predicted},
                       {"row_bytes", sizeof(Sample)},
                       {"rows", cbor_of(reply.rows)},
                       {"rest_to_rest", reply.rest_to_rest},
                       {"origin", reply.origin},
                       {"motion", to_text(reply.motion)},
                       {"learnt", reply.learnt}};
  const std::vector<std::uint8_t> bytes = Json::to_cbor(record);
  return {bytes.begin(), bytes.end()};
}

Reply from_record(std::string_view bytes) {
  const Json record = json_from_cbor<Json>(bytes);
  if (record.at("row_bytes") != sizeof(Sample)) throw std::runtime_error("its rows are those of another version");
  Reply reply;
  record.at("client").get_to(reply.id.client);
  record.at("number").get_to(reply.id.number);
  record.at("state").get_to(reply.state);
  record.at("reason").get_to(reply.why.reason);
  record.at("field").get_to(reply.why.field);
  record.at("sentence").get_to(reply.why.sentence);
  record.at("robot_id").get_to(reply.robot_id);
  record.at("robot_hash").get_to(reply.robot_hash);
  record.at("request_hash").get_to(reply.request_hash);
  record.at("version").get_to(reply.version);
  record.at("solve_time").get_to(reply.solve_time);
  record.at("wait_time").get_to(reply.wait_time);
  record.at("plan_json").get_to(reply.plan_json);
  record.at("certified_error").get_to(reply.errors.certified);
  record.at("predicted_error").get_to(reply.errors.predicted);
  reply.rows = items_in<Sample>(record.at("rows"));
  record.at("rest_to_rest").get_to(reply.rest_to_rest);
  record.at("origin").get_to(reply.origin);
  reply.motion = request_id_from(record.value("motion", "")).value_or(reply.id);  // earlier versions wrote none
  reply.learnt = record.value("learnt", false);
  return reply;
}

}  // namespace fjr
