#include <rospack/rospack.h>

#include <algorithm>
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

const std::string PACKAGE_SCHEME = "package:";
const std::string FILE_SCHEME = "file:";

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

std::string withoutLeadingSlashes(const std::string& text)
{
  return text.substr(std::min(text.find_first_not_of('/'), text.size()));
}

/** A path as written, or percent-decoded where only that exists. */
fs::path existing(const fs::path& folder, const std::string& path)
{
  const fs::path plain = folder / path;
  std::error_code ignored;
  return fs::exists(plain, ignored) ? plain : folder / decodePercent(path);
}

/** package://name/path; any number of slashes is one, as for ROS's own retriever. */
fs::path locateInPackage(const std::string& uri)
{
  const std::string rest = withoutLeadingSlashes(uri.substr(PACKAGE_SCHEME.size()));
  const size_t slash = std::min(rest.find('/'), rest.size());
  const std::string name = rest.substr(0, slash);
  const std::string package = name.empty() ? "" : findPackage(name);
  if (package.empty())
  {
    throw ModelError("'" + uri + "': no package '" + name + "' on ROS_PACKAGE_PATH = '" +
                     environment("ROS_PACKAGE_PATH") + "'");
  }
  return existing(package, withoutLeadingSlashes(rest.substr(slash)));
}

/**
 * file:/path, file:///path, file://localhost/path and more slashes are one absolute path; file://path and file:path
 * without one, which is no URI but in use, is relative to the folder.
 */
fs::path locateFile(const std::string& uri, const std::string& folder)
{
  std::string path = uri.substr(FILE_SCHEME.size());
  const std::string host = "//localhost/";
  if (startsWith(path, host))
    path.erase(0, host.size() - 1);
  const size_t slashes = path.size() - withoutLeadingSlashes(path).size();
  return existing(slashes == 0 || slashes == 2 ? folder : "/", withoutLeadingSlashes(path));
}

fs::path locate(const std::string& uri, const std::string& folder)
{
  if (startsWith(uri, PACKAGE_SCHEME))
    return locateInPackage(uri);
  if (startsWith(uri, FILE_SCHEME))
    return locateFile(uri, folder);
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
        startsWith(uri, PACKAGE_SCHEME) ? " (ROS_PACKAGE_PATH = '" + environment("ROS_PACKAGE_PATH") + "')" : "";
    throw ModelError("'" + uri + "': there is no file " + path.string() + searched);
  }
  return path.string();
}

}  // namespace frictional_contact_sim
