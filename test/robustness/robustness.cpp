// robustness DIR FIRST LAST [even|odd]: the random scenes of test/support/random_scene.h with seeds FIRST .. LAST - 1
// as scenario and URDF files, for scripts/judge_robustness and any run_scenario, this commit's or another one's.
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "support/random_scene.h"

int main(int argc, char** argv)
{
  if (argc < 4 || argc > 5)
  {
    std::cerr << "usage: robustness DIR FIRST LAST [even|odd]\n";
    return 2;
  }
  try
  {
    const std::string folder = argv[1];
    const unsigned long first = std::stoul(argv[2]);
    const unsigned long last = std::stoul(argv[3]);
    const std::string which = argc == 5 ? argv[4] : "";
    std::filesystem::create_directories(folder);
    for (unsigned long seed = first; seed < last; ++seed)
    {
      if (!which.empty() && (seed % 2 == 0) != (which == "even"))
        continue;
      const auto scene = frictional_contact_sim::test_support::randomScene(static_cast<std::uint32_t>(seed));
      writeScene(scene, folder, scene.scenario, scene.name());
    }
    return 0;
  }
  catch (const std::exception& error)
  {
    std::cerr << "robustness: " << error.what() << '\n';
    return 2;
  }
}
