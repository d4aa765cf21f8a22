#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace resilin {

/// One start tag of an XML document and the text after it, up to the next tag.
struct XmlTag {
  std::string name;  ///< "/Piece" for an end tag
  std::map<std::string, std::string, std::less<>> attributes;
  bool is_closed = false;  ///< <name/>
  std::string_view text;
  std::size_t text_begin = 0;  ///< position of `text` in the document

  /// The attribute, or `otherwise` when there is none.
  std::string attribute(std::string_view key, const std::string& otherwise = "") const;
};

/// The tags of a document in their order, as far as VTK files need XML: no entities but the five, no CDATA.
/// Stops behind the tag `last`, whose content may be bytes that are no XML.
///
/// @throws InputError "FILE: line N: ..."
std::vector<XmlTag> xml_tags(const std::string& file, std::string_view bytes, std::string_view last);

}  // namespace resilin
