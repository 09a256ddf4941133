#include "frictional_contact_sim/deformable/elastic_spec.h"

namespace frictional_contact_sim
{
namespace
{
ElasticParts partsOf(const ElasticSpec& spec)
{
  if (!spec.mass.empty())
    return readMatrices(spec.mass, spec.stiffness, spec.nodes);
  if (!spec.mesh.empty())
    return assembleElastic(readGmsh(spec.mesh), spec.material);
  return assembleElastic(spec.box.empty() ? barMesh(spec.bar, spec.cells.front()) : boxMesh(spec.box, spec.cells),
                         spec.material);
}
}  // namespace

std::shared_ptr<const ElasticSolid> buildElastic(const std::string& name, const ElasticSpec& spec)
{
  ElasticParts parts = partsOf(spec);
  std::vector<int> supports;
  const auto listed = parts.groups.find("fixed");  // a node table says which
  if (!spec.mass.empty() && listed != parts.groups.end())
    supports = listed->second;
  for (const std::string& group : spec.fixed)
  {
    const std::vector<int> nodes = nodesNamed(parts, group);
    supports.insert(supports.end(), nodes.begin(), nodes.end());
  }
  return std::make_shared<ElasticSolid>(name, std::move(parts), supports, spec.damping);
}

}  // namespace frictional_contact_sim
