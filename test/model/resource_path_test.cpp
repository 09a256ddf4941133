// resolvePath: the ways in which a URDF names a file, with random numbers of slashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;

/// A package with "meshes/part 1.stl" and a file of the same name above it, where a wrong path would lead.
class ResourcePathTest : public testing::Test
{
protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("resource_path_test_" + std::to_string(getpid()));
    file_ = folder_ / "slash_robot/meshes/part 1.stl";
    fs::create_directories(file_.parent_path());
    fs::create_directories(folder_ / "meshes");
    std::ofstream(folder_ / "slash_robot/package.xml")
        << "<package><name>slash_robot</name><version>1.0.0</version><description/></package>";
    std::ofstream(file_) << "solid";
    std::ofstream(folder_ / "meshes/part 1.stl") << "other";
    const char* path = std::getenv("ROS_PACKAGE_PATH");
    path_ = path == nullptr ? "" : path;
    setenv("ROS_PACKAGE_PATH", folder_.c_str(), 1);
  }
  void TearDown() override
  {
    setenv("ROS_PACKAGE_PATH", path_.c_str(), 1);
    fs::remove_all(folder_);
  }

  std::string slashes(int least) { return std::string(static_cast<size_t>(least) + random_() % 4, '/'); }
  std::string fileName() { return random_() % 2 == 0 ? "part 1.stl" : "part%201.stl"; }

  std::mt19937 random_{7};
  fs::path folder_;
  fs::path file_;
  std::string path_;
};

TEST_F(ResourcePathTest, AnyNumberOfSlashesInAPackageUriIsOne)
{
  for (int k = 0; k < 200; ++k)
  {
    const std::string uri = "package:" + slashes(2) + "slash_robot" + slashes(1) + "meshes" + slashes(1) + fileName();
    EXPECT_EQ(resolvePath(uri, "/"), file_.string()) << uri;
  }
}

TEST_F(ResourcePathTest, FileUrisWithAndWithoutHostAreAbsolute)
{
  const std::string inside = folder_.string().substr(1) + "/slash_robot/meshes/";
  for (int k = 0; k < 200; ++k)
  {
    const std::string head = random_() % 3 == 0   ? "file:/"
                             : random_() % 2 == 0 ? "file://localhost/"
                                                  : "file:" + slashes(3);
    const std::string uri = head + inside + fileName();
    EXPECT_EQ(resolvePath(uri, "/no/such/folder"), file_.string()) << uri;
  }
}

TEST_F(ResourcePathTest, FileUrisWithoutALeadingSlashAreRelativeToTheFolder)
{
  for (const std::string head : {"file://", "file:", ""})
    EXPECT_EQ(resolvePath(head + "meshes/part 1.stl", (folder_ / "slash_robot").string()), file_.string()) << head;
}

TEST_F(ResourcePathTest, WhatIsNotThereIsNamedAsWritten)
{
  for (const std::string uri : {"package://slash_robot//meshes/none.stl", "package://slash_robot", "package://",
                                "package:////none/x.stl", "file:///none.stl", "file://", "http://host/a.stl"})
  {
    try
    {
      resolvePath(uri, folder_.string());
      FAIL() << uri;
    }
    catch (const ModelError& error)
    {
      EXPECT_THAT(error.what(), testing::HasSubstr("'" + uri + "'"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }
}

}  // namespace
}  // namespace frictional_contact_sim
