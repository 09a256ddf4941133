// Ids of contact points: wide enough for any mesh and any number of shapes, in the order of shapes and features.
#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "frictional_contact_sim/collision/contact_id.h"

namespace frictional_contact_sim
{
namespace
{
constexpr int LAST_INDEX = (1 << FEATURE_INDEX_BITS) - 1;

/// In the order of the features: kind by kind, index by index.
std::vector<Feature> someFeatures()
{
  std::vector<Feature> features;
  for (const FeatureKind kind : {FeatureKind::VERTEX, FeatureKind::EDGE, FeatureKind::FACE, FeatureKind::CURVE})
    for (const int index : {0, 1, 4000, (1 << 14) - 1, 1 << 14, 240000, LAST_INDEX - 1, LAST_INDEX})
      features.push_back(makeFeature(kind, index));
  return features;
}

TEST(ContactIdTest, FeaturesAreInTheOrderOfKindAndIndex)
{
  const std::vector<Feature> features = someFeatures();
  for (size_t i = 1; i < features.size(); ++i)
    EXPECT_LT(features[i - 1], features[i]);
}

TEST(ContactIdTest, IdsAreInTheOrderOfShapesAndThenFeatures)
{
  std::vector<ContactId> ids;
  for (const int shape_a : {0, 1, 65536, 0x7fffffff})
    for (const int shape_b : {0, 70000, 0x7fffffff})
      for (const Feature feature_a : someFeatures())
        for (const Feature feature_b : someFeatures())
          ids.push_back(makeContactId(shape_a, shape_b, feature_a, feature_b));
  for (size_t i = 1; i < ids.size(); ++i)
  {
    ASSERT_TRUE(ids[i - 1] < ids[i]);
    ASSERT_FALSE(ids[i] < ids[i - 1]);
    ASSERT_TRUE(ids[i - 1] != ids[i]);
  }
}

TEST(ContactIdTest, NumbersOfDifferentIdsDiffer)
{
  std::set<std::uint64_t> numbers;
  size_t count = 0;
  for (int shape = 0; shape < 100; ++shape)
  {
    for (int a = 0; a < 30; ++a)
    {
      for (int b = 0; b < 30; ++b, ++count)
      {
        const ContactId id =
            makeContactId(shape, shape / 2, makeFeature(FeatureKind::VERTEX, a), makeFeature(FeatureKind::FACE, b));
        EXPECT_EQ(id.number(), ContactId(id).number());
        numbers.insert(id.number());
      }
    }
  }
  EXPECT_EQ(numbers.size(), count);
}

}  // namespace
}  // namespace frictional_contact_sim
