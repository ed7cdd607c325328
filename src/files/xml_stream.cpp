#include "files/xml_stream.h"

#include <algorithm>
#include <expat.h>
#include <fmt/format.h>
#include <new>

namespace aerate {

void XmlStream::Free::operator()(XML_ParserStruct* parser) const {
  XML_ParserFree(parser);
}

XmlStream::XmlStream() : parser_(XML_ParserCreate(nullptr)) {
  if (!parser_) throw std::bad_alloc();
  XML_SetUserData(parser_.get(), this);
  XML_SetElementHandler(
      parser_.get(),
      [](void* self, const char* name, const char** attributes) {
        static_cast<XmlStream*>(self)->begin_element(name, attributes);
      },
      [](void* self, const char*) { static_cast<XmlStream*>(self)->end_element(); });
  // Document types define entities, which grow to any size; 3MF forbids them.
  XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const char*, const char*, const char*, int) {
    auto* const stream = static_cast<XmlStream*>(self);
    stream->guarded([&] { stream->refuse("it has a document type (<!DOCTYPE>), which is not allowed"); });
  });
}

void XmlStream::read(std::string_view bytes) {
  parse(bytes, false);
  // The parser keeps a piece whole, and begins it anew with each block.
  const auto done = static_cast<std::size_t>(std::max<XML_Index>(XML_GetCurrentByteIndex(parser_.get()), 0));
  if (bytes_read_ > done + kLongestPiece)
    refuse(fmt::format("a tag or comment of more than {} bytes", kLongestPiece));
}

void XmlStream::finish() {
  parse({}, true);
}

void XmlStream::parse(std::string_view bytes, bool is_last) {
  const XML_Status status =
      XML_Parse(parser_.get(), bytes.data(), static_cast<int>(bytes.size()), is_last ? 1 : 0);
  bytes_read_ += bytes.size();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  if (status == XML_STATUS_OK) return;
  const XML_Error error = XML_GetErrorCode(parser_.get());
  if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
  refuse(fmt::format("not well-formed XML: {}", XML_ErrorString(error)));
}

template <typename F>
void XmlStream::guarded(const F& f) {
  if (failure_) return;
  try {
    f();
  } catch (...) {
    failure_ = std::current_exception();
    XML_StopParser(parser_.get(), XML_FALSE);
  }
}

void XmlStream::begin_element(const char* name, const char** attributes) {
  guarded([&] {
    if (++depth_ > kMostNested) refuse(fmt::format("elements are nested deeper than {}", kMostNested));
    element_.attributes.clear();
    for (; *attributes != nullptr; attributes += 2) {
      const std::string_view attribute = attributes[0];
      element_.attributes.push_back({attribute, attributes[1]});
      declare(attribute, attributes[1]);
    }
    const std::string_view whole = name;
    const std::size_t colon = whole.find(':');
    element_.prefix = colon == std::string_view::npos ? std::string_view() : whole.substr(0, colon);
    element_.name = colon == std::string_view::npos ? whole : whole.substr(colon + 1);
    begin(element_);
  });
}

// Notes what "xmlns" and "xmlns:prefix" say; other attributes pass.
void XmlStream::declare(std::string_view attribute, std::string_view name) {
  constexpr std::string_view kDeclaration = "xmlns";
  if (!attribute.starts_with(kDeclaration)) return;
  attribute.remove_prefix(kDeclaration.size());
  if (!attribute.empty() && attribute.front() != ':') return;
  if (declarations_.size() == kMostNamespaces)
    refuse(fmt::format("more than {} namespaces", kMostNamespaces));
  declarations_.push_back(
      {std::string(attribute.empty() ? attribute : attribute.substr(1)), std::string(name), depth_});
}

void XmlStream::end_element() {
  guarded([&] {
    end();
    while (!declarations_.empty() && declarations_.back().depth == depth_) declarations_.pop_back();
    --depth_;
  });
}

std::size_t XmlStream::line() const {
  return XML_GetCurrentLineNumber(parser_.get());
}

std::size_t XmlStream::column() const {
  return XML_GetCurrentColumnNumber(parser_.get()) + 1;
}

std::string_view XmlStream::namespace_of(std::string_view prefix) const {
  const auto last = std::find_if(declarations_.rbegin(), declarations_.rend(),
                                 [&](const Declaration& d) { return d.prefix == prefix; });
  return last == declarations_.rend() ? std::string_view() : last->name;
}

}  // namespace aerate
