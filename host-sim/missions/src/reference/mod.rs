//! The paper's full-horizon problems (Sections II-A and II-B), solved offline on small instances. The cost of the best
//! sequence of `M` motions is compared with that of algorithms that plan a step or two ahead.
//!
//! # What is printed
//!
//! *Section II-A*, labels that are true. Over policies and over lines `z = rho x + c`, minimise
//! `rho^2 / 2 + sum |u(t)|^2`, `t = 0 .. M-1`, so that
//!
//! 1. every sample is a metre above or below the line, on the side of its label: `y(t) (z(t) - rho x(t) - c) >= 1`,
//!    `t = 1 .. M`;
//! 2. so are the oracle's points;
//! 3. both labels are seen equally often, but for one: `|sum y(t)| <= 1`, `t = 0 .. M`;
//! 4. motions are those of the dynamics, and `y(t) = sgn(z(t) - rho* x(t) - c*)`.
//!
//! *Section II-B*, labels that are true with probability `p`. Minimise
//! `E[sum Y(j) sgn(Z(j) - rho X(j) - c)] + E[sum |U(j)|^2]` for the dynamics, with no further constraint.
//!
//! # What it means here
//!
//! **The line is known to the optimiser.** The true line stands in constraint 4, and nothing is averaged or maximised
//! over it. A policy is followed along one path only. So the best policy is the best sequence of motions for that line:
//! an optimum in hindsight. A policy that has to find the line needs a criterion over the possible lines, which the
//! paper does not give. No such policy pays less for this line than the optimum here. So its excess is the price of not
//! knowing the line and of looking no further than a step.
//!
//! **The cost of the line has two readings,** as the paper's text and formula disagree ([`objective::LineCost`]). The
//! text asks for the line that is furthest from the samples. The classical formula for it scales the sides of
//! constraint 1, so that the cost is `1 / (2 margin^2)`. The paper drops the scale of `z`. So a margin of one metre
//! along `z` becomes a hard constraint, and `rho^2 / 2` prefers lines along the x axis. The printed reading is the
//! default; the margin is an option.
//!
//! **Errata.** The constraints of the oracle's points of label -1 are `<= -1`. In Section II-B agreement has to be
//! maximised, not minimised; the best value is the same either way. The true label in Section II-B lacks a bracket.
//! Arguments of policies end at `t - 1` in the problem and at `t` in the definition; in hindsight that is the same.
//!
//! **A line whose +1 side is below** is solved upside down (half a turn does not change `rho`). A vertical line has no
//! printed cost and is refused.
//!
//! **Motions** are those of the scenario's vehicle that stay in its area, as for the planners. Standing still is a
//! motion, and gives a sample of its own. The paper's samples may lie anywhere, on certain ground too. Only its
//! one-step problems forbid that.
//!
//! **Section II-B is solved by standing still.** Its cost contains only true labels, and any line that divides them has
//! the best one. So the noise does not matter, and each motion costs. The optimum is `-(M + 1)`, reached without moving
//! if a vehicle can stand still. The paper says of the similar cost in Section II-A that it does not enforce learning
//! (III-A).
//!
//! # How it is solved
//!
//! By branch and bound over sequences of actions ([`search`]). The lower bound for a partial sequence is the sum of
//! three terms. The first is the cost so far. The second is the cost of the line, which only grows with more samples.
//! The third is for the motions that the balance of labels still requires. It comes from a relaxed problem of two
//! numbers, distance from the true line and heading ([`relaxation`]). Among equal costs the sequence with the lower
//! action indices wins. Instances that are too large are refused beforehand ([`size`]).

pub mod account;
pub mod flight;
pub mod instance;
pub mod margin;
pub mod objective;
pub mod optimum;
pub mod relaxation;
pub mod search;
pub mod size;
pub mod slopes;
pub mod solution;
