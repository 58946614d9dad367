// The objects that are drawn with the arm: all parts of a request that have a place in the plane of motion.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "model/parameters.h"
#include "planner/results/json_field.h"

namespace fjr {

// Objects for plan_page.js, in m, each with a label:
//   {kind: "disc", center, radius, margin}  {kind: "box", corners: [[x, y], [x, y]]}  {kind: "point", at}
//   {kind: "line", from, to, tolerance}     {kind: "curve", points}   {kind: "wall", at, normal}
//   {kind: "arc", center, radius, from, to, tolerance}, with angles counterclockwise from the x axis.
nlohmann::ordered_json scene_json(const JsonField& plan, const Parameters& robot);

}  // namespace fjr
