// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/file_bytes.hpp"

#include <cerrno>
#include <fstream>
#include <system_error>

#include "common/io/read_error.hpp"

namespace clearway::io {

std::string ReadFileBytes(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw ErrorInFile(file, "no such file");
  if (!std::filesystem::is_regular_file(status)) throw ErrorInFile(file, "is not a file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw ErrorInFile(file, "cannot be read: " + error.message());
  if (size == 0) throw ErrorInFile(file, "is empty (0 bytes)");
  if (size > kMaxFileBytes) {
    throw ErrorInFile(file,
                      "has " + std::to_string(size) + " bytes; at most " +
                          std::to_string(kMaxFileBytes) + " are read");
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!stream || !stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw ErrorInFile(file, "cannot be read: " + std::generic_category().message(errno));
  }
  return bytes;
}

}  // namespace clearway::io
