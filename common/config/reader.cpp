// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/reader.hpp"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include <tinyxml2.h>

#include "common/config/config_error.hpp"
#include "common/config/names.hpp"
#include "common/config/overrides.hpp"
#include "common/config/problems.hpp"
#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

/// What tinyxml2's error numbers mean to the writer of a file.
std::string DescribeError(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file is empty: expected <clearway version=\"1\">";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "malformed XML: an attribute is incomplete, not in quotes or given twice";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "malformed XML: an opening and a closing tag do not match";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "malformed XML: a comment does not end";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "malformed XML: an element has no legal name or does not end";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "malformed XML: text outside of all elements or without an end";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested too deeply";
    default:
      return std::string("malformed XML: ") + tinyxml2::XMLDocument::ErrorIDToName(error);
  }
}

/// Walks an XML document beside the tree of elements that it should fill.
class Reader {
 public:
  Reader(const std::string& file, Problems& problems) : file_(file), problems_(problems) {}

  /// False when there is no root element to read values from.
  [[nodiscard]] bool ReadDocument(const std::string& text, Element& root) {
    tinyxml2::XMLDocument document;
    const tinyxml2::XMLElement* const top = Parse(text, document, root);
    if (top == nullptr) return false;
    for (const auto* node = document.FirstChild(); node != nullptr; node = node->NextSibling())
      CheckBesideRoot(*node, *top, root);
    if (top->Name() != kRootName) {
      Add(top->GetLineNum(),
          root,
          "the root element is <" + Shown(top->Name()) + ">: expected <clearway version=\"1\">");
      return false;
    }
    CheckVersion(*top, root);
    ReadElement(*top, root);
    return true;
  }

 private:
  /// The root element, or null after a problem was told.
  const tinyxml2::XMLElement* Parse(const std::string& text,
                                    tinyxml2::XMLDocument& document,
                                    const Element& root) {
    // tinyxml2 would stop there and take what stands before it for the whole file.
    if (text.find('\0') != std::string::npos) {
      Add(0, root, "the file holds a zero byte: expected UTF-8 text");
      return nullptr;
    }
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      Add(document.ErrorLineNum(), root, DescribeError(document.ErrorID()));
      return nullptr;
    }
    // Null for a file that holds only comments.
    if (document.RootElement() == nullptr)
      Add(0, root, "there is no element: expected <clearway version=\"1\">");
    return document.RootElement();
  }

  void Add(int line, const Element& element, const std::string& text, std::string value = {}) {
    const std::string place = line > 0 ? Concat({":", std::to_string(line)}) : "";
    problems_.Add({.line = line,
                   .element = element.path,
                   .value = std::move(value),
                   .text = file_ + place + ": " + text});
  }

  void CheckBesideRoot(const tinyxml2::XMLNode& node,
                       const tinyxml2::XMLElement& top,
                       const Element& root) {
    if (&node == &top || node.ToComment() != nullptr || node.ToDeclaration() != nullptr) return;
    if (node.ToText() != nullptr && Trim(node.Value()).empty()) return;
    const std::string shown = Shown(node.Value());
    const std::string what = node.ToElement() != nullptr ? "<" + shown + ">"
                             : node.ToText() != nullptr  ? "text \"" + shown + "\""
                                                         : "<!" + shown + ">";
    Add(node.GetLineNum(), root, what + " beside the root element: expected one element only");
  }

  void CheckVersion(const tinyxml2::XMLElement& top, const Element& root) {
    const tinyxml2::XMLAttribute* const version = top.FindAttribute("version");
    if (version == nullptr) {
      Add(top.GetLineNum(), root, "<clearway> needs the attribute version: expected version=\"1\"");
    } else if (version->Value() != kVersion) {
      Add(version->GetLineNum(),
          root,
          "<clearway> version=\"" + Shown(version->Value()) + "\": expected \"1\"");
    }
  }

  void ReadElement(const tinyxml2::XMLElement& xml, Element& element) {
    element.line = xml.GetLineNum();
    for (const auto* attribute = xml.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next())
      ReadAttribute(*attribute, element);
    ReadChildren(xml, element);
  }

  void ReadAttribute(const tinyxml2::XMLAttribute& attribute, Element& element) {
    const std::string_view name = attribute.Name();
    if (element.path.empty() && name == kVersionName) return;
    const int line = attribute.GetLineNum();
    Value* const value = FindValue(element, name);
    if (value == nullptr) {
      return Add(line,
                 element,
                 ShownPath(element.path) + " has " +
                     DescribeUnknown("attribute", name, ValueNames(element)));
    }
    if (value->write(attribute.Value())) {
      value->origin = file_ + ":" + std::to_string(line);
      return;
    }
    Add(line,
        element,
        ShownPath(element.path) + " " + std::string(name) + "=\"" + Shown(attribute.Value()) +
            "\": " + DescribeExpected(*value),
        JoinPath(element.path, name));
  }

  using XmlItems = std::map<std::string_view, std::vector<const tinyxml2::XMLElement*>>;

  void ReadChildren(const tinyxml2::XMLElement& xml, Element& element) {
    XmlItems items;
    for (const auto* node = xml.FirstChild(); node != nullptr; node = node->NextSibling()) {
      if (const tinyxml2::XMLElement* const child = node->ToElement()) {
        CollectChild(*child, element, items);
      } else {
        CheckNode(*node, element);
      }
    }
    for (Member& member : element.members) {
      Child* const child = std::get_if<Child>(&member);
      if (child == nullptr) continue;
      const auto found = items.find(child->name);
      if (found == items.end()) continue;
      if (child->is_list) {
        ReadList(found->second, element, *child);
      } else {
        ReadElement(*found->second.front(), child->items.front());
      }
    }
  }

  void CollectChild(const tinyxml2::XMLElement& xml, Element& element, XmlItems& items) {
    const std::string_view name = xml.Name();
    Child* const child = FindChild(element, name);
    if (child == nullptr) {
      return Add(xml.GetLineNum(),
                 element,
                 ShownPath(element.path) + " has " +
                     DescribeUnknown("element", name, ChildNames(element)));
    }
    std::vector<const tinyxml2::XMLElement*>& same = items[child->name];
    same.push_back(&xml);
    if (child->is_list || same.size() == 1) return;
    Add(xml.GetLineNum(),
        element,
        ShownPath(element.path) + " has <" + std::string(name) +
            "> again: expected at most one, the first is at line " +
            std::to_string(same.front()->GetLineNum()));
  }

  /// Comments and white space may stand between elements, nothing else.
  void CheckNode(const tinyxml2::XMLNode& node, const Element& element) {
    if (node.ToComment() != nullptr) return;
    const std::string_view text = Trim(node.Value());
    if (node.ToText() != nullptr && text.empty()) return;
    Add(node.GetLineNum(),
        element,
        ShownPath(element.path) + " contains \"" + Shown(text) +
            "\": expected only elements and comments; values are attributes");
  }

  void ReadList(const std::vector<const tinyxml2::XMLElement*>& items,
                const Element& element,
                Child& child) {
    num_list_items_ += items.size();
    if (num_list_items_ > kMostListItems) {
      return Add(items.front()->GetLineNum(),
                 element,
                 ShownPath(element.path) + " has too many <" + std::string(child.name) +
                     "> elements: expected at most " + std::to_string(kMostListItems) +
                     " in all lists of a file");
    }
    child.items = child.reset(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) ReadElement(*items[i], child.items[i]);
  }

  const std::string& file_;
  Problems& problems_;
  std::size_t num_list_items_ = 0;
};

}  // namespace

Source ReadSource(const std::filesystem::path& file) {
  Source source{.file = file.string(), .text = {}};
  const auto fail = [&source](const std::string& reason) {
    throw ConfigError({source.file + ": cannot read the file: " + reason});
  };
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(
      std::fopen(source.file.c_str(), "rb"), &std::fclose);
  if (stream == nullptr) fail(std::generic_category().message(errno));
  source.text.resize(kLargestFileBytes + 1);
  source.text.resize(std::fread(source.text.data(), 1, source.text.size(), stream.get()));
  if (std::ferror(stream.get()) != 0) fail(std::generic_category().message(errno));
  if (source.text.size() > kLargestFileBytes) fail("it is larger than 1 MiB");
  return source;
}

Origins Fill(Element& root, const Source& source, std::span<const std::string> overrides) {
  Problems problems;
  if (Reader(source.file, problems).ReadDocument(source.text, root)) {
    ApplyOverrides(overrides, root, problems);
    CheckRules(root, source.file, problems);
  }
  std::vector<std::string> texts = problems.Texts();
  if (!texts.empty()) throw ConfigError(std::move(texts));
  Origins origins;
  ForEachValue(root, [&origins](const std::string& path, const Value& value) {
    if (!value.origin.empty()) origins[path] = value.origin;
  });
  return origins;
}

}  // namespace clearway::config::internal
