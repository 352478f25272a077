// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

/// Of comments; leaves room for their end on a page of 100 columns.
constexpr std::size_t kLineWidth = 96;

std::string EscapeXml(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// Words of the text in lines of at most kLineWidth characters, each behind the indent.
std::string Wrap(std::string_view text, const std::string& indent) {
  std::string wrapped = indent;
  std::size_t column = indent.size();
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const bool is_first = column == indent.size();
    if (!is_first && column + 1 + word.size() > kLineWidth) {
      wrapped += "\n" + indent;
      column = indent.size();
    } else if (!is_first) {
      wrapped += ' ';
      ++column;
    }
    wrapped += word;
    column += word.size();
  }
  return wrapped + "\n";
}

/// XML comments must not contain "--" nor end in '-'.
std::string ToCommentText(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at))
    text.insert(at + 1, 1, ' ');
  return text;
}

/// Writes a tree of elements, one after the other, into one text.
class XmlWriter {
 public:
  void Write(const Element& element,
             const Element* defaults,
             std::string_view name,
             std::string_view help) {
    if (defaults != nullptr) WriteHelp(*defaults, help);
    WriteOpening(element, name);
    bool has_children = false;
    indent_ += "  ";
    for (std::size_t i = 0; i < element.members.size(); ++i) {
      const Child* const child = std::get_if<Child>(&element.members[i]);
      if (child == nullptr || child->items.empty()) continue;
      if (!has_children) xml_ += ">\n";
      has_children = true;
      WriteItems(*child, defaults == nullptr ? nullptr : &std::get<Child>(defaults->members[i]));
    }
    indent_.resize(indent_.size() - 2);
    xml_ += has_children ? indent_ + "</" + std::string(name) + ">\n" : "/>\n";
  }

  [[nodiscard]] const std::string& xml() const { return xml_; }

 private:
  void WriteItems(const Child& child, const Child* defaults) {
    if (defaults == nullptr) {
      for (const Element& item : child.items) Write(item, nullptr, child.name, {});
      return;
    }
    const Element prototype = child.is_list ? child.make_prototype() : defaults->items.front();
    for (const Element& item : child.items) {
      // One item of a list explains them all.
      const bool is_first = &item == &child.items.front();
      Write(item, is_first ? &prototype : nullptr, child.name, child.help);
    }
  }

  void WriteOpening(const Element& element, std::string_view name) {
    const std::string opening = indent_ + "<" + std::string(name);
    xml_ += opening;
    bool is_first = true;
    const auto add = [&](std::string_view attribute, std::string_view text) {
      xml_ += is_first ? " " : Concat({"\n", std::string(opening.size() + 1, ' ')});
      xml_ += std::string(attribute) + "=\"" + EscapeXml(text) + "\"";
      is_first = false;
    };
    if (element.path.empty()) add(kVersionName, kVersion);
    for (const Member& member : element.members) {
      if (const Value* const value = std::get_if<Value>(&member)) add(value->name, value->read());
    }
  }

  void WriteHelp(const Element& defaults, std::string_view help) {
    std::string comment;
    if (!help.empty()) comment += Wrap(ToCommentText(std::string(help)), indent_ + "     ");
    for (const Member& member : defaults.members) {
      const Value* const value = std::get_if<Value>(&member);
      if (value == nullptr) continue;
      const std::string text = Concat(
          {value->name, ": ", value->help, " Allowed: ", value->expected, DescribeDefault(*value)});
      comment += Wrap(ToCommentText(text), indent_ + "     ");
    }
    if (comment.empty()) return;
    comment.replace(0, indent_.size() + 5, indent_ + "<!-- ");
    comment.pop_back();
    xml_ += comment + " -->\n";
  }

  std::string xml_ = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  std::string indent_;
};

/// FNV-1a, 64 bits. Source: Fowler, Noll, Vo, Eastlake: The FNV Non-Cryptographic Hash Algorithm
/// (RFC 9923), section 2.
class Fnv1a {
 public:
  void Add(std::string_view text) {
    for (const char c : text) AddByte(static_cast<unsigned char>(c));
    AddByte(0);
  }

  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  void AddByte(unsigned char byte) { hash_ = (hash_ ^ byte) * 0x100000001b3U; }

  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace

std::string PrintValues(const Element& root, const Origins& origins) {
  std::string lines;
  ForEachValue(root, [&](const std::string& path, const Value& value) {
    const auto found = origins.find(path);
    lines += path + " = " + PrintedText(value, value.read()) + "  # " +
             (found == origins.end() ? "default" : found->second) + "\n";
  });
  return lines;
}

std::string WriteXml(const Element& root, const Element* defaults) {
  XmlWriter writer;
  writer.Write(root, defaults, kRootName, {});
  return writer.xml();
}

std::string ComputeDigest(const Element& root) {
  Fnv1a digest;
  ForEachValue(root, [&digest](const std::string& path, const Value& value) {
    digest.Add(path);
    digest.Add(value.read());
  });
  std::array<char, 16> digits{};
  char* const end =
      std::to_chars(digits.data(), digits.data() + digits.size(), digest.hash(), 16).ptr;
  const std::string hex(digits.data(), end);
  return std::string(digits.size() - hex.size(), '0') + hex;
}

}  // namespace clearway::config::internal
