#pragma once
/**
 * @file mesh_library.h
 * @brief The shapes of collision geometries; each mesh file is read once, however many links have it.
 */
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "frictional_contact_sim/collision/convex_shape.h"

namespace frictional_contact_sim
{
class MeshLibrary
{
public:
  /**
   * @brief One shape, for a mesh one of each convex part.
   * @param warnings takes what the hulls add to a mesh, if that is notable
   * @throws ModelError naming link, file and reason
   */
  std::vector<ConvexShape> shapesOf(const Geometry& geometry, const std::string& link,
                                    std::vector<std::string>* warnings);

private:
  struct Entry
  {
    std::vector<Polyhedron> hulls;
    std::string addition;
  };
  /// By file and scale; never changed once they are read, so that copies may be used in several threads.
  std::map<std::tuple<std::string, double, double, double>, std::shared_ptr<const Entry>> entries_;
};

}  // namespace frictional_contact_sim
