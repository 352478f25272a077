// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lzf.hpp"

#include <utility>

namespace clearway::io {

namespace {

constexpr std::size_t kFirstReference = 32;
constexpr std::size_t kLongLength = 7;
constexpr std::size_t kShortestReference = 2;

class LzfDecoder {
 public:
  LzfDecoder(std::string_view packed, std::size_t unpacked_size) : packed_(packed) {
    result_.bytes.resize(unpacked_size);
  }

  LzfResult Run() {
    while (position_ < packed_.size() && result_.problem.empty()) {
      result_.offset = position_;
      const std::size_t control = Byte(position_++);
      if (control < kFirstReference) {
        CopyLiterals(control + 1);
      } else {
        CopyReference(control);
      }
    }
    if (result_.problem.empty() && filled_ != result_.bytes.size()) {
      result_.offset = position_;
      result_.problem = "compressed data end after " + std::to_string(filled_) + " of " +
                        std::to_string(result_.bytes.size()) + " bytes";
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::size_t Byte(std::size_t i) const {
    return static_cast<unsigned char>(packed_[i]);
  }

  void CopyLiterals(std::size_t length) {
    if (length > packed_.size() - position_) {
      result_.problem = "a literal run goes beyond the end of the compressed data";
      return;
    }
    if (!Fits(length)) return;
    packed_.copy(result_.bytes.data() + filled_, length, position_);
    position_ += length;
    filled_ += length;
  }

  void CopyReference(std::size_t control) {
    std::size_t length = control >> 5U;
    const std::size_t more_bytes = length == kLongLength ? 2 : 1;
    if (more_bytes > packed_.size() - position_) {
      result_.problem = "a back reference goes beyond the end of the compressed data";
      return;
    }
    if (length == kLongLength) length += Byte(position_++);
    length += kShortestReference;
    const std::size_t distance = ((control & 0x1fU) << 8U | Byte(position_++)) + 1;
    if (distance > filled_) {
      result_.problem = "a back reference points " + std::to_string(distance) +
                        " bytes back, only " + std::to_string(filled_) + " are unpacked";
      return;
    }
    if (!Fits(length)) return;
    // Byte by byte: a range may repeat what this very copy has written.
    for (const std::size_t end = filled_ + length; filled_ < end; ++filled_) {
      result_.bytes[filled_] = result_.bytes[filled_ - distance];
    }
  }

  bool Fits(std::size_t length) {
    if (length <= result_.bytes.size() - filled_) return true;
    result_.problem = "compressed data unpack to more than the announced " +
                      std::to_string(result_.bytes.size()) + " bytes";
    return false;
  }

  std::string_view packed_;
  std::size_t position_ = 0;
  std::size_t filled_ = 0;
  LzfResult result_;
};

}  // namespace

LzfResult DecompressLzf(std::string_view packed, std::size_t unpacked_size) {
  return LzfDecoder(packed, unpacked_size).Run();
}

}  // namespace clearway::io
