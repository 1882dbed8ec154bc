// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The values that enter and leave a filter's run, by port name.

#include <cassert>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/kinds/value.hpp"

namespace scanmill {

class Inputs {
public:
    void add(std::string port, Value value) { values_[std::move(port)].push_back(std::move(value)); }

    /// The value wired to `port`. Pre: it is wired and of kind T; the engine checks both.
    template <class T>
    const T& get(std::string_view port) const {
        const T* object = find<T>(port);
        assert(object);
        return *object;
    }
    /// The value wired to `port`; nullptr if there is none or if it has another accepted kind.
    template <class T>
    const T* find(std::string_view port) const {
        const auto found = values_.find(port);
        if (found == values_.end()) return nullptr;
        return found->second.front().find<T>();
    }
    /// All values wired to a list port, in order.
    template <class T>
    std::vector<std::shared_ptr<const T>> list(std::string_view port) const {
        std::vector<std::shared_ptr<const T>> objects;
        if (const auto found = values_.find(port); found != values_.end())
            for (const Value& value : found->second) objects.push_back(value.get<T>());
        return objects;
    }

private:
    std::map<std::string, std::vector<Value>, std::less<>> values_;
};

class Outputs {
public:
    template <class T>
    Outputs& set(std::string port, T object) {
        values_.emplace_back(std::move(port), std::make_shared<const T>(std::move(object)));
        return *this;
    }
    Outputs& set(std::string port, Value value) {
        values_.emplace_back(std::move(port), std::move(value));
        return *this;
    }
    /// nullptr if the filter set no value for `port`.
    const Value* find(std::string_view port) const {
        for (const auto& [name, value] : values_)
            if (name == port) return &value;
        return nullptr;
    }
    auto begin() const { return values_.begin(); }
    auto end() const { return values_.end(); }

private:
    std::vector<std::pair<std::string, Value>> values_;
};

}  // namespace scanmill
