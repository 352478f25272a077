// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "common/messages/channel.hpp"
#include "common/messages/encoding.hpp"
#include "common/process/runtime.hpp"

/// Typed channels for who is no node of the graph: nothing is numbered and no status is published.
namespace clearway::process {

template <typename Message>
void Publish(Runtime& runtime, const messages::Channel<Message>& channel, const Message& message) {
  runtime.Publish(channel.bus, channel.name, messages::Encode(message));
}

/// Messages that cannot be decoded go to `on_invalid`.
template <typename Message>
void Subscribe(Runtime& runtime,
               const messages::Channel<Message>& channel,
               std::function<void(const Message&)> handler,
               std::function<void()> on_invalid) {
  runtime.Subscribe(channel.bus,
                    channel.name,
                    [handler = std::move(handler),
                     on_invalid = std::move(on_invalid)](std::span<const std::byte> bytes) {
                      const std::optional<Message> message = messages::Decode<Message>(bytes);
                      if (message) {
                        handler(*message);
                      } else {
                        on_invalid();
                      }
                    });
}

}  // namespace clearway::process
