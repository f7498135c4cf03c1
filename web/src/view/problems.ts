// Errors as the problems that the page shows.

import type { Problem } from "../engine/engine.ts";

/** The problem of anything that was thrown. */
export function problemOf(problem: unknown): Problem {
  if (typeof problem === "object" && problem !== null && "message" in problem) {
    const code = "code" in problem ? String(problem.code) : "failed";
    return { ...(problem as Problem), code, message: String(problem.message) };
  }
  return { code: "failed", message: String(problem) };
}
