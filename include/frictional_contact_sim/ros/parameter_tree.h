#pragma once
/**
 * @file parameter_tree.h
 * @brief Parameters of the node as ConfigNodes, beside YAML the other back end of the one reader
 * (config/config_node.h).
 */
#include <string>
#include <vector>

#include "frictional_contact_sim/config/config_node.h"

namespace XmlRpc
{
class XmlRpcValue;
}

namespace frictional_contact_sim
{
/**
 * @param tree content of the node's private namespace; anything but a struct counts as empty
 * @param warnings takes a line for each parameter that nobody knows
 */
ConfigNode parameterTree(const XmlRpc::XmlRpcValue& tree, std::vector<std::string>* warnings);

}  // namespace frictional_contact_sim
