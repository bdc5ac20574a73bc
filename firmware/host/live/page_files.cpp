// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/page_files.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "firmware/host/config/inside_folder.hpp"

namespace fovea::live {
namespace {

namespace fs = std::filesystem;

const char* TypeOf(const fs::path& file) {
  constexpr std::array<std::pair<std::string_view, const char*>, 9> kTypes{{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
  }};
  const std::string extension = file.extension();
  for (const auto& [known, type] : kTypes) {
    if (extension == known) {
      return type;
    }
  }
  return "application/octet-stream";
}

PageFile ReadPageFile(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw std::runtime_error(path.string() + ": missing; the live page needs it");
  }
  return {{std::istreambuf_iterator<char>(stream), {}}, TypeOf(path)};
}

}  // namespace

PageFiles::PageFiles(const fs::path& page, const fs::path& shared) {
  const fs::path index = page / "index.html";
  if (!fs::is_regular_file(index)) {
    throw std::runtime_error(index.string() + ": missing; the live page needs it");
  }
  AddFolder(page, "/");
  if (fs::is_directory(shared)) {
    AddFolder(shared, "/shared/");
  }
  std::vector<std::string> pages;
  for (const auto& [path, file] : files_) {
    if (path.ends_with(".html")) {
      pages.push_back(file.content);
    }
  }
  for (const std::string& html : pages) {
    AddLibrariesOf(html);
  }
  files_["/"] = files_.at("/index.html");
  files_.erase("/index.html");  // so that the page has one address, which needs the token
}

void PageFiles::AddFolder(const fs::path& folder, const std::string& prefix) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files_[prefix + fs::relative(entry.path(), folder).generic_string()] = ReadPageFile(entry.path());
    }
  }
}

// Finds src="lib/..." and href="lib/...", also with a slash before.
void PageFiles::AddLibrariesOf(const std::string& html) {
  const fs::path libraries = FOVEA_JAVASCRIPT_FOLDER;
  for (const std::string_view mark : {"\"lib/", "\"/lib/"}) {
    for (std::size_t at = html.find(mark); at != std::string::npos; at = html.find(mark, at + 1)) {
      const std::size_t begin = at + mark.size();
      const std::string name = html.substr(begin, html.find('"', begin) - begin);
      if (!config::IsInside(libraries, name)) {
        throw std::runtime_error(name + ": the live page names a library outside " + libraries.string());
      }
      files_["/lib/" + name] = ReadPageFile(libraries / name);
    }
  }
}

const PageFile* PageFiles::Find(std::string_view path) const {
  const auto file = files_.find(path);
  return file == files_.end() ? nullptr : &file->second;
}

}  // namespace fovea::live
