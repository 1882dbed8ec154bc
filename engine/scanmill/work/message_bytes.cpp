// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/message_bytes.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::json;

/// Reads over a message and keeps nothing.
class DepthCheck : public Json::json_sax_t {
public:
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return enter(); }
    bool key(string_t&) override { return true; }
    bool end_object() override { return leave(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_array() override { return leave(); }
    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
        what_ = error.what();
        return false;
    }
    const std::string& what() const { return what_; }

private:
    bool enter() {
        constexpr int deepest = 16;
        return ++depth_ <= deepest;
    }
    bool leave() {
        --depth_;
        return true;
    }
    int depth_ = 0;
    std::string what_ = "it nests too deep";
};

}  // namespace

std::string bytes_of(const Json& json) {
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

Json json_of(std::string_view message) {
    DepthCheck check;
    if (!Json::sax_parse(message, &check, Json::input_format_t::cbor))
        throw Error("a message between runner and worker cannot be understood: {}", check.what());
    return Json::from_cbor(message);
}

}  // namespace scanmill
