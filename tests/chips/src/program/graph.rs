//! The call graph of a linked program, read from its machine code.
//!
//! The target of a call through a register is not guessed. If the program can reach such a call, the caller must be
//! among those whose targets are known; otherwise there is no graph. A function that nothing points to cannot be such a
//! target, so the known targets are checked as well.

use std::collections::{BTreeMap, BTreeSet};

use super::body::Body;
use super::image::{Image, Symbol};

/// Functions that call through a register, by name, and what each calls in this way.
pub type Known<'a> = &'a [(&'a str, &'a [&'a str])];

/// Everything a program's functions call and point to. Functions are named by their addresses.
#[derive(Clone, Debug)]
pub struct Graph<'a> {
    image: &'a Image,
    bodies: BTreeMap<u32, Body>,
    /// Where a function's calls through registers lead.
    through: BTreeMap<u32, Vec<u32>>,
}

/// A chain of calls and the stack that it takes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chain {
    /// Bytes.
    pub stack: u32,
    /// The functions, outermost first.
    pub functions: Vec<u32>,
}

impl<'a> Graph<'a> {
    /// Reads all of a program.
    ///
    /// # Errors
    /// When a function moves the stack pointer in a way that cannot be followed, or calls an address that is no
    /// function. Also when a function that can run calls through a register and is not among the known.
    pub fn of(image: &'a Image, known: Known<'_>) -> Result<Self, String> {
        let mut bodies = BTreeMap::new();
        for function in image.functions() {
            let body = Body::of(image, function)?;
            let mut targets = body.sites.iter().filter_map(|it| it.target);
            if let Some(nowhere) = targets.find(|it| image.function(*it).is_none()) {
                return Err(format!("{} calls {nowhere:#010x}, no function", function.name));
            }
            bodies.insert(function.address, body);
        }
        let mut graph = Self { image, bodies, through: BTreeMap::new() };
        for (name, targets) in known {
            for caller in graph.named(|it| it == *name) {
                if graph.is_indirect(caller) {
                    let targets = graph.resolve(name, targets)?;
                    graph.through.insert(caller, targets);
                }
            }
        }
        for function in graph.closure(&image.handlers()) {
            if graph.is_indirect(function) && !graph.through.contains_key(&function) {
                let name = graph.name(function);
                return Err(format!("{name} calls through a register: where does that lead?"));
            }
        }
        Ok(graph)
    }

    fn is_indirect(&self, function: u32) -> bool {
        self.bodies[&function].sites.iter().any(|site| site.target.is_none())
    }

    fn resolve(&self, caller: &str, targets: &[&str]) -> Result<Vec<u32>, String> {
        let mut addresses = Vec::new();
        for target in targets {
            let before = addresses.len();
            let named = self.named(|it| it == *target).into_iter();
            addresses.extend(named.filter(|it| self.is_pointed_to(*it)));
            if addresses.len() == before {
                return Err(format!("{caller} cannot call {target}: nothing points to that"));
            }
        }
        Ok(addresses)
    }

    fn is_pointed_to(&self, function: u32) -> bool {
        let thumb = function | 1;
        self.bodies.values().any(|it| it.constants.contains(&thumb)) || self.image.mentions(thumb)
    }

    /// What a function is called.
    pub fn name(&self, function: u32) -> &'a str {
        self.image.function(function).map_or("?", |it| &it.name)
    }

    /// The functions whose name passes a test.
    pub fn named(&self, test: impl Fn(&str) -> bool) -> Vec<u32> {
        let named = self.image.functions().iter().filter(|it| test(&it.name));
        named.map(|it| it.address).collect()
    }

    /// What a function calls, with its own stack at the call.
    fn calls(&self, function: u32) -> Vec<(u32, u32)> {
        let Some(body) = self.bodies.get(&function) else { return Vec::new() };
        let mut calls = Vec::new();
        for site in &body.sites {
            if let Some(to) = site.target {
                // A call into the midst of a function, as assembly has them, is one of it.
                calls.extend(self.image.function(to).map(|it| (it.address, site.depth)));
            } else {
                let targets = self.through.get(&function).into_iter().flatten();
                calls.extend(targets.map(|to| (*to, site.depth)));
            }
        }
        calls
    }

    /// The functions that a function calls directly.
    pub fn callees(&self, function: u32) -> BTreeSet<u32> {
        self.calls(function).into_iter().map(|(to, _)| to).collect()
    }

    /// Functions, and all that runs on their behalf.
    pub fn closure(&self, roots: &[u32]) -> BTreeSet<u32> {
        let mut reached = BTreeSet::new();
        let mut open = roots.to_vec();
        while let Some(function) = open.pop() {
            if reached.insert(function) {
                open.extend(self.callees(function));
            }
        }
        reached
    }

    /// Bytes of flash of functions, and of the constants that they, or these in turn, point to.
    pub fn flash(&self, functions: &BTreeSet<u32>) -> u32 {
        let image = self.image;
        let bodies = functions.iter().filter_map(|it| self.bodies.get(it));
        let mut open: Vec<u32> = bodies.flat_map(|it| it.constants.iter().copied()).collect();
        let mut constants: BTreeMap<u32, &Symbol> = BTreeMap::new();
        while let Some(pointer) = open.pop() {
            let Some(constant) = image.constant(pointer) else { continue };
            if constants.insert(constant.address, constant).is_none() {
                let words = (constant.address..constant.address + constant.size).step_by(4);
                open.extend(words.filter_map(|at| image.word(at)));
            }
        }
        let code: u32 =
            functions.iter().filter_map(|it| image.function(*it)).map(|it| it.size).sum();
        code + constants.values().map(|it| it.size).sum::<u32>()
    }

    /// The chain of calls from a function that takes the most stack. It goes no further where it comes to
    /// one of the functions `without`.
    ///
    /// # Errors
    /// When there is recursion; the error says which.
    pub fn deepest(&self, function: u32, without: &[u32]) -> Result<Chain, String> {
        let mut known: BTreeMap<u32, Chain> = BTreeMap::new();
        known.extend(without.iter().map(|it| (*it, Chain::default())));
        self.expand(function, &mut Vec::new(), &mut known)
    }

    fn descend(
        &self,
        function: u32,
        path: &mut Vec<u32>,
        known: &mut BTreeMap<u32, Chain>,
    ) -> Result<Chain, String> {
        if let Some(chain) = known.get(&function) {
            return Ok(chain.clone());
        }
        if let Some(start) = path.iter().position(|it| *it == function) {
            path.push(function);
            let names: Vec<&str> = path[start..].iter().map(|it| self.name(*it)).collect();
            return Err(format!("recursion: {}", names.join(" -> ")));
        }
        let chain = self.expand(function, path, known)?;
        known.insert(function, chain.clone());
        Ok(chain)
    }

    fn expand(
        &self,
        function: u32,
        path: &mut Vec<u32>,
        known: &mut BTreeMap<u32, Chain>,
    ) -> Result<Chain, String> {
        path.push(function);
        let own = self.bodies.get(&function).map_or(0, |it| it.depth);
        let mut deepest = Chain { stack: own, functions: vec![] };
        for (callee, depth) in self.calls(function) {
            let Chain { stack, functions } = self.descend(callee, path, known)?;
            if depth + stack > deepest.stack {
                deepest = Chain { stack: depth + stack, functions };
            }
        }
        path.pop();
        deepest.functions.insert(0, function);
        Ok(deepest)
    }
}

#[cfg(test)]
mod tests {
    use super::super::image::Section;
    use super::*;

    /// A program of functions one after the other, from 0x100 on; its vectors have the first.
    fn program(functions: &[(&str, &[u16])]) -> Image {
        let mut image = Image {
            sections: Vec::new(),
            flash: 0,
            functions: Vec::new(),
            constants: Vec::new(),
            turns: vec![(0, false), (0x100, true)],
        };
        let mut code = Vec::new();
        for (name, halfwords) in functions {
            let (address, size) = (0x100 + code.len() as u32, 2 * halfwords.len() as u32);
            image.functions.push(Symbol { name: (*name).into(), address, size });
            code.extend(halfwords.iter().flat_map(|it| it.to_le_bytes()));
        }
        let vectors = [0, 0, 0, 0, 1, 1, 0, 0].to_vec();
        for (name, address, bytes) in [(".vector_table", 0, vectors), (".text", 0x100, code)] {
            let size = bytes.len() as u32;
            let name = name.into();
            image.sections.push(Section { name, address, size, bytes, writable: false });
        }
        image
    }

    const NOP: u16 = 0xbf00;

    #[test]
    fn the_deepest_chain_counts_a_tail_call_after_the_frame_is_gone() {
        // push {r4, lr}; bl leaf; pop {r4, lr as r5}; b.n deep
        let root = [0xb510, 0xf000, 0xf803, 0xbc30, 0xe003, NOP];
        // sub sp, #8; add sp, #8; bx lr; and with 64
        let image = program(&[
            ("root", &root),
            ("leaf", &[0xb082, 0xb002, 0x4770]),
            ("deep", &[0xb090, 0xb010, 0x4770]),
        ]);
        let graph = Graph::of(&image, &[]).expect("plain code");
        let chain = graph.deepest(0x100, &[]).expect("no recursion");
        let names: Vec<&str> = chain.functions.iter().map(|it| graph.name(*it)).collect();
        assert_eq!((chain.stack, &*names), (64, &["root", "deep"][..]));
        assert_eq!(graph.callees(0x100).len(), 2);
    }

    #[test]
    fn recursion_is_an_error_that_names_the_cycle() {
        // push {r4, lr}; bl other; pop {r4, pc}; and back
        let image = program(&[
            ("one", &[0xb510, 0xf000, 0xf801, 0xbd10]),
            ("other", &[0xb510, 0xf7ff, 0xfff9, 0xbd10]),
        ]);
        let graph = Graph::of(&image, &[]).expect("plain code");
        let error = graph.deepest(0x100, &[]).expect_err("recursion");
        assert_eq!(error, "recursion: one -> other -> one");
    }

    #[test]
    fn what_cannot_be_followed_is_an_error() {
        let error = |code: &[u16]| Graph::of(&program(&[("it", code)]), &[]).err();
        // no instructions: of no kind, of coprocessor 15, of Advanced SIMD, between the reversals; mov sp, r7; sub sp, #8 for ever; blx r0; bl to nowhere
        let unknown = "it holds what is not known here, at 0x00000100";
        let cases: [(&[u16], &str); 8] = [
            (&[0xb700, 0x4770], unknown),
            (&[0xee01, 0x0f10, 0x4770], unknown),
            (&[0xff00, 0x0110, 0x4770], unknown),
            (&[0xba80, 0x4770], unknown),
            (&[0x46bd, 0x4770], "it moves the stack pointer at 0x00000100"),
            (&[0xb082, 0xe7fd], "it has a stack without an end"),
            (&[0x4780, 0x4770], "it calls through a register: where does that lead?"),
            (&[0xf001, 0xf800, 0x4770], "it calls 0x00001104, no function"),
        ];
        for (code, expected) in cases {
            assert_eq!(error(code).as_deref(), Some(expected));
        }
    }
}
