#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct XML_ParserStruct;

namespace aerate {

struct XmlAttribute {
  std::string_view name;  // as written, with its prefix
  std::string_view value;
};

// An element as it begins.
struct XmlElement {
  std::string_view prefix, name;  // "m" and "color" of <m:color>
  std::vector<XmlAttribute> attributes;
};

// An XML document read from its front to its end, a block at a time, by expat: elements alone matter. UTF-8,
// UTF-16 and what else expat knows; prefixes need not be declared, as slicers do not ask for it. A document
// beyond the limits below, or with a document type, is refused.
class XmlStream {
 public:
  static constexpr std::size_t kMostNested = 256;                     // elements
  static constexpr std::size_t kLongestPiece = std::size_t{1} << 20;  // bytes of a tag or comment
  static constexpr std::size_t kMostNamespaces = 256;                 // in force at one place

  XmlStream();
  virtual ~XmlStream() = default;
  XmlStream(const XmlStream&) = delete;
  XmlStream& operator=(const XmlStream&) = delete;

  // The next bytes, and the document's end. Throw what `begin`, `end` and `refuse` throw.
  void read(std::string_view bytes);
  void finish();

 protected:
  virtual void begin(const XmlElement& element) = 0;
  virtual void end() = 0;
  // Has to throw.
  virtual void refuse(const std::string& why) = 0;

  std::size_t line() const;
  std::size_t column() const;
  // The namespace that a prefix stands for here; empty for one that is not declared. "" is the default one.
  std::string_view namespace_of(std::string_view prefix) const;

 private:
  struct Declaration {
    std::string prefix, name;
    std::size_t depth;
  };
  struct Free {
    void operator()(XML_ParserStruct* parser) const;
  };

  void parse(std::string_view bytes, bool is_last);
  void begin_element(const char* name, const char** attributes);
  void end_element();
  void stop();
  void declare(std::string_view attribute, std::string_view name);
  template <typename F>
  void guarded(const F& f);

  std::unique_ptr<XML_ParserStruct, Free> parser_;
  XmlElement element_;  // the attributes' room is used again
  std::vector<Declaration> declarations_;
  std::size_t depth_ = 0, bytes_read_ = 0;
  std::exception_ptr failure_;  // C code lies between who throws and who catches
};

}  // namespace aerate
