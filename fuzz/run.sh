#!/bin/sh
# Runs every fuzz target for FUZZ_SECONDS (100): by cargo-fuzz, with its address sanitizer, where that and a nightly
# compiler are installed; else by the stable compiler, whose own passes count which branches were taken. Inputs that were
# new are kept in fuzz/corpus, those that fail in fuzz/artifacts.
set -eu
cd "$(dirname "$0")"
seconds="${FUZZ_SECONDS:-100}"
targets=$(sed -n 's/^name = "\(.*\)"$/\1/p' Cargo.toml | grep -v '^wavesplat-fuzz$')

if cargo fuzz --version >/dev/null 2>&1 && cargo +nightly --version >/dev/null 2>&1; then
    cd ..
    for target in $targets; do
        cargo +nightly fuzz run "$target" -- -max_total_time="$seconds" -max_len=256 -len_control=0
    done
    exit
fi

# What cargo-fuzz passes, less the sanitizer, which only nightly has.
export RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1"
# A target of its own, so that build scripts are not counted.
host=$(rustc -vV | sed -n 's/^host: //p')
cargo build --release --target "$host" --target-dir ../target/fuzz
for target in $targets; do
    mkdir -p "corpus/$target" "artifacts/$target"
    "../target/fuzz/$host/release/$target" -max_total_time="$seconds" -max_len=256 -len_control=0 \
        -artifact_prefix="artifacts/$target/" "corpus/$target"
done
