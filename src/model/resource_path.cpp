#include <rospack/rospack.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>

#include "frictional_contact_sim/model/urdf_loader.h"

namespace frictional_contact_sim
{
namespace
{
namespace fs = std::filesystem;

std::string environment(const char* name)
{
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/**
 * Folder of a ROS package, "" when there is none. A crawl reads a good part of the disk, so what was found is kept for
 * as long as ROS_PACKAGE_PATH stays the same and the folder exists; what was not found is searched again.
 */
std::string findPackage(const std::string& name)
{
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, std::string> found;
  const std::lock_guard<std::mutex> lock(mutex);
  std::string& folder = found[{environment("ROS_PACKAGE_PATH"), name}];
  std::error_code ignored;
  if (!folder.empty() && fs::is_directory(folder, ignored))
    return folder;
  folder.clear();
  rospack::Rospack rospack;
  rospack.setQuiet(true);
  std::vector<std::string> search_path;
  if (rospack.getSearchPathFromEnv(search_path))
  {
    // rospack's cache file first; it may be a minute old, so a package it does not know is looked for on the disk.
    rospack.crawl(search_path, false);
    if (!rospack.find(name, folder))
    {
      rospack.crawl(search_path, true);
      if (!rospack.find(name, folder))
        folder.clear();
    }
  }
  return folder;
}

bool startsWith(const std::string& text, const std::string& prefix)
{
  return text.compare(0, prefix.size(), prefix) == 0;
}

/** "a%20b" -> "a b": file URIs are percent-encoded. */
std::string decodePercent(const std::string& text)
{
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i)
  {
    if (text[i] == '%' && i + 2 < text.size() && std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
        std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0)
    {
      decoded += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    }
    else
    {
      decoded += text[i];
    }
  }
  return decoded;
}

fs::path locate(const std::string& uri, const std::string& folder)
{
  static const std::string PACKAGE = "package://";
  static const std::string FILE = "file://";
  if (startsWith(uri, PACKAGE))
  {
    const size_t slash = uri.find('/', PACKAGE.size());
    const std::string name = uri.substr(PACKAGE.size(), slash == std::string::npos ? slash : slash - PACKAGE.size());
    const std::string package = findPackage(name);
    if (package.empty())
    {
      throw ModelError("'" + uri + "': no package '" + name + "' on ROS_PACKAGE_PATH = '" +
                       environment("ROS_PACKAGE_PATH") + "'");
    }
    return slash == std::string::npos ? fs::path(package) : fs::path(package) / uri.substr(slash + 1);
  }
  if (startsWith(uri, FILE))
  {
    // file://localhost/path and file:///path name the same file.
    std::string path = uri.substr(FILE.size());
    path.erase(0, startsWith(path, "localhost/") ? std::string("localhost").size() : 0);
    const fs::path plain(path);
    std::error_code ignored;
    return fs::exists(plain, ignored) ? plain : fs::path(decodePercent(path));
  }
  if (uri.find("://") != std::string::npos)
    throw ModelError("'" + uri + "': expected package://, file:// or a path");
  return fs::path(folder) / uri;  // an absolute uri replaces the folder
}
}  // namespace

std::string resolvePath(const std::string& uri, const std::string& folder)
{
  const fs::path path = fs::absolute(locate(uri, folder)).lexically_normal();
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored))
  {
    const std::string searched =
        startsWith(uri, "package://") ? " (ROS_PACKAGE_PATH = '" + environment("ROS_PACKAGE_PATH") + "')" : "";
    throw ModelError("'" + uri + "': there is no file " + path.string() + searched);
  }
  return path.string();
}

}  // namespace frictional_contact_sim
