// What a scenario says of its loops.
#include "loop_keys.h"

#include <set>

#include "frictional_contact_sim/math/roll_pitch_yaw.h"
#include "frictional_contact_sim/simulation/scenario_keys.h"

namespace frictional_contact_sim
{
namespace
{
const std::string WORLD = "world";

Eigen::Vector3d readAxis(const ConfigNode& node)
{
  const Eigen::Vector3d axis = node.vector<3>();
  if (!(axis.norm() > 1e-9))
    node.failExpecting("a direction");
  return axis;
}

/** @param body of a side that names none. @param axis of one that has none of its own */
LoopSide readSide(const ConfigNode& node, LoopType type, const std::string& body, Eigen::Vector3d axis)
{
  LoopSide side;
  side.body = body;
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();
  node.readMap({key("body", [&](const ConfigNode& name) { side.body = name.text(); }),
                key("link", [&](const ConfigNode& name) { side.link = name.text(); }), key("xyz", xyz), key("rpy", rpy),
                key("axis", [&](const ConfigNode& own) { axis = readAxis(own); })});
  if (node.has("axis") && type != LoopType::AXIS)
    node.at("axis").failExpecting("none in a loop of type " + std::string(toString(type)));
  if (side.body.empty())
    node.fail("has no body, expected one: there is more than one");
  if (side.body == WORLD)
    side.body.clear();
  if (side.body.empty() != side.link.empty())
    node.fail(side.link.empty() ? "has no link, expected one of body '" + side.body + "'"
                                : "has a link of the world, expected none");
  side.placement = Eigen::Translation3d(xyz) * fromRollPitchYaw(rpy);
  if (type == LoopType::AXIS)
    side.placement.linear() = side.placement.linear() * orientationAlong(axis);
  return side;
}

LoopSpec readLoop(const ConfigNode& node, size_t number, const std::string& only_body)
{
  LoopSpec loop;
  loop.source = node.place();
  loop.name = "loop_" + std::to_string(number);
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  const auto none = [](const ConfigNode&) {};
  node.readMap(
      {key("name", [&](const ConfigNode& name) { loop.name = name.text(); }),
       required(key("type", loop.type,
                    Choices<LoopType>{{"point", LoopType::POINT}, {"axis", LoopType::AXIS}, {"weld", LoopType::WELD}})),
       key("axis", [&](const ConfigNode& own) { axis = readAxis(own); }), required(key("a", none)),
       required(key("b", none))});
  if (node.has("axis") && loop.type != LoopType::AXIS)
    node.at("axis").failExpecting("none in a loop of type " + std::string(toString(loop.type)));
  loop.a = readSide(node.at("a"), loop.type, only_body, axis);
  loop.b = readSide(node.at("b"), loop.type, loop.a.body.empty() ? only_body : loop.a.body, axis);
  return loop;
}
}  // namespace

void readLoops(const ConfigNode& node, Scenario& scenario)
{
  const std::string only_body = scenario.bodies.size() == 1 ? scenario.bodies.front().name : "";
  std::set<std::string> names;
  for (const ConfigNode& loop : node.items("loops"))
  {
    scenario.loops.push_back(readLoop(loop, scenario.loops.size(), only_body));
    if (!names.insert(scenario.loops.back().name).second)
      loop.fail("found name '" + scenario.loops.back().name + "' twice, expected different names");
  }
}

}  // namespace frictional_contact_sim
