#pragma once
/**
 * @file contact_id.h
 * @brief What a contact point is known by from step to step: the two shapes and the features of theirs that touch.
 */
#include <cstdint>

namespace frictional_contact_sim
{
/// Number of a feature of one shape: kind in the two high bits, index in the other 30.
using Feature = std::uint32_t;
enum class FeatureKind : std::uint32_t
{
  VERTEX,
  EDGE,
  FACE,
  CURVE  ///< points of a cylinder's rim and side, see CylinderFeature
};
constexpr int FEATURE_INDEX_BITS = 30;
constexpr Feature makeFeature(FeatureKind kind, int index)
{
  constexpr Feature INDEX = (Feature{1} << FEATURE_INDEX_BITS) - 1;
  return (static_cast<Feature>(kind) << FEATURE_INDEX_BITS) | (static_cast<Feature>(index) & INDEX);
}

/** @brief Shape handles and features of a contact point, that of a first: no two points of a world share an id. */
struct ContactId
{
  std::uint64_t shapes = 0;  ///< shape_a, shape_b: 32 bits each
  std::uint64_t features = 0;  ///< feature of a, feature of b: 32 bits each

  /**
   * @brief The id as one number, for messages and CSV files: equal for equal ids; different ids share a number with a
   * probability of 2^-64. Finaliser of splitmix64 (Steele, Lea, Flood 2014) on one word after the other.
   */
  constexpr std::uint64_t number() const
  {
    constexpr std::uint64_t GOLDEN = 0x9e3779b97f4a7c15ULL;
    return mix(mix(shapes + GOLDEN) + GOLDEN + features);
  }

private:
  static constexpr std::uint64_t mix(std::uint64_t z)
  {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
};

constexpr ContactId makeContactId(int shape_a, int shape_b, Feature feature_a, Feature feature_b)
{
  return {(static_cast<std::uint64_t>(static_cast<std::uint32_t>(shape_a)) << 32) | static_cast<std::uint32_t>(shape_b),
          (static_cast<std::uint64_t>(feature_a) << 32) | feature_b};
}
constexpr FeatureKind kindOf(Feature feature)
{
  return static_cast<FeatureKind>(feature >> FEATURE_INDEX_BITS);
}
constexpr Feature featureA(const ContactId& id)
{
  return static_cast<Feature>(id.features >> 32);
}
constexpr Feature featureB(const ContactId& id)
{
  return static_cast<Feature>(id.features);
}
constexpr bool operator==(const ContactId& a, const ContactId& b)
{
  return a.shapes == b.shapes && a.features == b.features;
}
constexpr bool operator!=(const ContactId& a, const ContactId& b)
{
  return !(a == b);
}
/** @brief By shape_a, shape_b, feature of a, feature of b. */
constexpr bool operator<(const ContactId& a, const ContactId& b)
{
  return a.shapes != b.shapes ? a.shapes < b.shapes : a.features < b.features;
}

}  // namespace frictional_contact_sim
