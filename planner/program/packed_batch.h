// Batches in few files, planned chunk by chunk on whatever machine: `fjr batch prepare`, run, gather, status, unpack.
#pragma once

namespace CLI {
class App;
}

namespace fjr {

void add_packed_batches(CLI::App& batch, int& exit_code);

}  // namespace fjr
