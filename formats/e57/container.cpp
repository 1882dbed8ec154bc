// SPDX-License-Identifier: GPL-3.0-or-later
#include "e57/container.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::e57_format {

namespace {

constexpr u64 page_size = 1024, page_content = 1020;
constexpr std::size_t header_size = 48;
constexpr u64 most_xml = 16u << 20;  // a scan needs about 5 KiB
/// The standard nests 8 elements at most, and extensions add few.
constexpr std::size_t most_depth = 64;
/// libE57Format compares the name of a new child with all earlier ones of its parent: 10^8 comparisons take 2 s. They
/// allow 10,000 scans and as many images; a structure of the standard has 20 children.
constexpr u64 most_comparisons = 100'000'000;

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
    T number;  // little-endian, as every x86-64
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

/// The XML section without the checksums of its pages.
std::string xml_of(std::string_view bytes) {
    if (bytes.size() < header_size)
        throw Error("has only {}; the header of an E57 file has {}", count_text(bytes.size(), "byte", "bytes"),
                    header_size)
            .hint(truncated_hint);
    if (!bytes.starts_with("ASTM-E57")) throw Error("is not an E57 file: it does not begin with ASTM-E57");
    const u32 major = number_at<u32>(bytes, 8), minor = number_at<u32>(bytes, 12);
    if (major != 1 || minor != 0)
        throw Error("is E57 of version {}.{}; version 1.0 is read", major, minor)
            .hint("export it as E57 1.0, or fetch it again if it is damaged");
    if (const u64 size = number_at<u64>(bytes, 40); size != page_size)
        throw Error("its header promises pages of {}; E57 has pages of {}", count_text(size, "byte", "bytes"),
                    page_size)
            .hint(truncated_hint);
    const u64 promised = number_at<u64>(bytes, 16);
    if (promised != bytes.size() || promised % page_size != 0)
        throw Error("its header promises {}; the file has {}{}", count_text(promised, "byte", "bytes"), bytes.size(),
                    promised == bytes.size() ? fmt::format(", which are not whole pages of {}", page_size) : "")
            .hint(truncated_hint);
    const u64 begin = number_at<u64>(bytes, 24), length = number_at<u64>(bytes, 32);
    const u64 pages = bytes.size() / page_size;
    const bool begins_inside = begin >= header_size && begin < bytes.size() && begin % page_size < page_content;
    const u64 skipped = begin / page_size * page_content + begin % page_size;  // content bytes before the section
    if (!begins_inside || length == 0 || length > pages * page_content - skipped)
        throw Error("its XML section, {} from byte {}, is not inside the file of {}",
                    count_text(length, "byte", "bytes"), begin, count_text(bytes.size(), "byte", "bytes"))
            .hint(truncated_hint);
    if (length > most_xml)
        throw Error("its XML section has {}; at most {} are read", byte_size_text(length), byte_size_text(most_xml))
            .hint("split the file: export its scans into several files");
    std::string xml;
    xml.reserve(length);
    for (u64 at = begin; xml.size() < length; at = (at / page_size + 1) * page_size) {
        const u64 part = std::min(page_content - at % page_size, length - xml.size());
        xml.append(bytes.substr(at, part));
    }
    return xml;
}

/// Walks over the tags of an XML text. What it accepts need not be well-formed: the XML parser checks that later.
class Outline {
public:
    explicit Outline(std::string_view xml) : xml_(without_byte_order_mark(xml)) {}

    Contents contents() {
        if (!xml_.starts_with('<'))
            throw Error("its XML section begins with {}, not with '<'", quote(xml_.substr(0, 8)));
        require_utf8();
        std::size_t at = 0;
        while ((at = xml_.find('<', at)) != std::string_view::npos) {
            const std::string_view rest = xml_.substr(at);
            if (rest.starts_with("<?"))
                at = after("?>", at);
            else if (rest.starts_with("<!--"))
                at = after("-->", at + 4);
            else if (rest.starts_with("<![CDATA["))
                at = after("]]>", at);
            else if (rest.starts_with("<!"))
                throw Error("its XML section declares a document type, which E57 does not have");
            else if (rest.starts_with("</"))
                at = end_tag(at);
            else
                at = start_tag(at);
        }
        if (!open_.empty()) throw Error("its XML section ends inside of an element").hint(truncated_hint);
        return contents_;
    }

private:
    std::size_t after(std::string_view end, std::size_t at) const {
        const std::size_t found = xml_.find(end, at);
        if (found == std::string_view::npos) throw Error("its XML section ends inside of a tag").hint(truncated_hint);
        return found + end.size();
    }

    /// In another encoding, tags could hide from this class. The XML parser finds UTF-16 and UCS-4 by their zero bytes,
    /// whatever is declared.
    void require_utf8() const {
        if (const std::size_t at = xml_.find('\0'); at != std::string_view::npos)
            throw Error("its XML section has a zero byte, as UTF-16 has: byte {}; E57 has UTF-8", at);
        if (!xml_.starts_with("<?xml")) return;
        std::string declaration(xml_.substr(0, after("?>", 0)));
        std::ranges::transform(declaration, declaration.begin(), [](unsigned char c) { return std::tolower(c); });
        if (declaration.find("encoding") != std::string::npos && declaration.find("utf-8") == std::string::npos)
            throw Error("its XML section is not declared as UTF-8: {}", quote(declaration));
    }

    std::size_t end_tag(std::size_t at) {
        if (open_.empty()) throw Error("its XML section ends an element that did not begin");
        open_.pop_back();
        return after(">", at);
    }

    std::size_t start_tag(std::size_t at) {
        std::size_t end = at;
        for (char quoted = '\0'; end < xml_.size() && (quoted != '\0' || xml_[end] != '>'); ++end) {
            const char c = xml_[end];
            if (quoted != '\0')
                quoted = c == quoted ? '\0' : quoted;
            else if (c == '"' || c == '\'')
                quoted = c;
        }
        if (end == xml_.size()) throw Error("its XML section ends inside of a tag").hint(truncated_hint);
        const std::string_view tag = xml_.substr(at + 1, end - at - 1);
        if (tag.find("chemaLocation") != std::string_view::npos)
            throw Error(
                "its XML section names the location of a schema; scanmill reads no other files for an E57 file");
        begin(tag.substr(0, tag.find_first_of(" \t\r\n/")));
        if (tag.ends_with('/')) open_.pop_back();
        return end + 1;
    }

    void begin(std::string_view name) {
        if (!open_.empty()) comparisons_ += open_.back().children++;
        if (comparisons_ > most_comparisons)
            throw Error("its XML section has elements with too many children: {} has {} or more",
                        quote(open_.back().name), open_.back().children);
        if (open_.size() == 2) {
            contents_.scans += open_.back().name == "data3D";
            contents_.images += open_.back().name == "images2D";
        }
        if (open_.size() == most_depth) throw Error("its XML section nests more than {} elements", most_depth);
        open_.push_back({name, 0});
    }

    struct Element {
        std::string_view name;
        u32 children;
    };
    std::string_view xml_;
    std::vector<Element> open_;
    u64 comparisons_ = 0;  // of libE57Format, with the children of all elements
    Contents contents_;
};

}  // namespace

Contents checked_contents(std::string_view bytes) {
    const std::string xml = xml_of(bytes);
    return Outline(xml).contents();
}

}  // namespace scanmill::e57_format
