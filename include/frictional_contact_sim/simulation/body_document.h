#pragma once
/**
 * @file body_document.h
 * @brief What a body was loaded from, for those who draw it later.
 */
#include <string>

#include "frictional_contact_sim/simulation/scenario.h"

namespace frictional_contact_sim
{
struct BodyDocument
{
  std::string urdf;  ///< the document; empty where its file cannot be read any more
  std::string folder;  ///< whole path that relative mesh paths start from; empty for a document without a file
};

BodyDocument bodyDocument(const BodySpec& spec);

}  // namespace frictional_contact_sim
