"""Node trees -> shader programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...core.scene.shading import Feature, Program
from .assemble import Statement, assemble, live_instructions, statement
from .inputs import bump_width
from .media import belongs, misplaced
from .node import Node, Owner, Surroundings, label
from .shaders import MOST_LOBES, from_value, lobe_count, unknown
from .table import NODES
from .trees import Feed, Groups
from .values import ONE, ORIGIN, UNMOVED, ZERO, BumpOffset, Folding, Graph, Value, number

Key = tuple[int, tuple[int, ...], BumpOffset]
ShaderKey = tuple[int, tuple[int, ...]]
BUMP_WIDTH = number(0.1)  # of what a displacement gives, in pixels
MIXERS = {"MIX_SHADER", "ADD_SHADER"}


@dataclass(slots=True)
class _Visit:
    """A node whose inputs are being evaluated."""

    node: Node
    offset: BumpOffset
    needs: Iterator[tuple[str, Any, Feed, BumpOffset]]
    waiting: tuple[str, Any, Feed, BumpOffset] | None = None


@dataclass(slots=True)
class _Mixer:
    """A Mix or Add Shader: which shaders it joins, each with its factor."""

    parts: list[tuple[ShaderKey, Value]]


@dataclass(slots=True)
class Compiled:
    """A compiled tree, before registers are assigned."""

    graph: Graph
    statements: list[Statement]
    features: Feature
    empty: bool = False  # nothing is linked, or only what is known not to emit

    def program(self, name: str) -> Program:
        return assemble(name, self.graph, self.statements, self.features)

    def operations(self) -> set[str]:
        """Names of the operations that a program of it would have, closures included."""
        live = live_instructions(self.graph, self.statements)
        return {self.graph.instructions[i].operation.name for i in live} | {
            made.operation.name for made in self.statements
        }

    def knows_shadow_rays(self) -> bool:
        """Whether its result may be another one for them."""
        live = (self.graph.instructions[i] for i in live_instructions(self.graph, self.statements))
        return any(
            operand.kind == "m" and value == operand.modes.index("IS_SHADOW_RAY")
            for made in live
            if made.operation.name == "LightPath"
            for operand, value in zip(made.operation.operands, made.operands, strict=True)
        )


@dataclass(slots=True)
class Compiler:
    """Compiles one tree. Neither depth nor size of a tree is limited by Python's stack."""

    owner: Owner
    around: Surroundings
    folding: Folding
    graph: Graph = field(init=False)
    _values: dict[Key, dict[str, Value]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.graph = Graph(self.folding)

    # --- surfaces ---

    def surface(self, socket: Any, displacement: Any = None, displaced: bool = False) -> Compiled:
        """Closures of what is linked to `socket` (an output node's Surface), with normals bent by
        `displacement` (its Displacement); `displaced`: which has moved the surface already.
        """
        if displacement is not None:
            self.owner.normal = self._bent_normal(displacement, displaced)
        order, mixers, leaves, root = self._shaders(socket)
        weights: dict[ShaderKey, Value] = {root: ONE} if root is not None else {}
        statements: list[Statement] = []
        features = Feature(0)
        constant_emission = empty = True
        for key in order:
            weight = weights.get(key, ZERO)
            if weight == ZERO:
                continue
            if key in mixers:
                for part, factor in mixers[key].parts:
                    share = self.graph.multiply(weight, factor)
                    weights[part] = self.graph.add_numbers(weights.get(part, ZERO), share)
                continue
            made, produces = self._leaf(leaves[key], weight)
            empty = empty and not made and _shines(leaves[key])
            statements += [one for one in made if one.weight != ZERO]
            if produces & Feature.EMITS and not produces & Feature.CONSTANT_EMISSION:
                constant_emission = False
            features |= produces
        lobes = sum(lobe_count(made) for made in statements)
        if self.owner.normal is not None and lobes:
            bent = statement("BentNormal", weight=ONE, normal=self.owner.normal)
            statements.insert(0, bent)
        if lobes > MOST_LOBES:
            said = (
                f"its shaders may come to {lobes} lobes at one point; what is beyond "
                f"{MOST_LOBES} there is left out"
            )
            self.around.report.warn(f"{self.owner.name}: {said}")
        if not constant_emission:
            features &= ~Feature.CONSTANT_EMISSION
        return Compiled(self.graph, statements, features, empty)

    def _shaders(
        self, socket: Any
    ) -> tuple[list[ShaderKey], dict[ShaderKey, _Mixer], dict[ShaderKey, Feed], ShaderKey | None]:
        """All shaders above `socket`, those that are mixed after the mixers: order, mixers, leaves
        and the first one's key.
        """
        root = self._shader_feed(socket, ())
        if root is None:
            return [], {}, {}, None
        mixers: dict[ShaderKey, _Mixer] = {}
        leaves: dict[ShaderKey, Feed] = {}
        done: list[ShaderKey] = []  # what is mixed before the mixer
        state: dict[ShaderKey, bool] = {}  # False: its parts are being looked at
        stack: list[tuple[Feed, bool]] = [(root, False)]
        while stack:
            self.around.watch.go_on()
            feed, parts_done = stack.pop()
            key = _shader_key(feed)
            if parts_done:
                state[key] = True
                done.append(key)
                continue
            if key in state:
                continue
            state[key] = False
            stack.append((feed, True))
            if feed.node is None or feed.node.type not in MIXERS:
                leaves[key] = feed
                continue
            mixer = mixers[key] = _Mixer([])
            for part, factor in self._parts(feed):
                part_key = _shader_key(part)
                if state.get(part_key) is False:
                    self._report_loop(feed.node)
                    continue
                mixer.parts.append((part_key, factor))
                stack.append((part, False))
        done.reverse()
        return done, mixers, leaves, _shader_key(root)

    def _parts(self, feed: Feed) -> list[tuple[Feed, Value]]:
        node = feed.node
        if node.type == "ADD_SHADER":
            factors = [ONE, ONE]
        else:
            fraction = self.graph.one("ClampUnit", a=self.value(node.inputs[0], feed.groups))
            factors = [self.graph.one("OneMinus", a=fraction), fraction]
        sockets = (socket for socket in node.inputs if socket.type == "SHADER")
        used = [
            (socket, factor)
            for socket, factor in zip(sockets, factors, strict=True)
            if factor != ZERO
        ]
        found = [(self._shader_feed(socket, feed.groups), factor) for socket, factor in used]
        return [(part, factor) for part, factor in found if part is not None]

    def _shader_feed(self, socket: Any, groups: Groups) -> Feed | None:
        """What feeds an input for shaders; None where nothing does."""
        feed = self.around.trees.feed(socket, groups)
        if feed is None:
            self._report_loop(socket.node)
            return None
        if feed.node is None:
            return feed if feed.socket.type != "SHADER" else None
        return feed

    def _leaf(self, feed: Feed, weight: Value) -> tuple[list[Statement], Feature]:
        node = feed.node
        if node is None or feed.socket.type != "SHADER":
            n = Node(node or feed.socket.node, feed.groups, self.graph, self.owner, self.around)
            if node is not None:
                if not self._gives(feed):
                    return [], Feature(0)
                self._evaluate(feed, UNMOVED)
            return from_value(n, weight, self._result(feed, "RGBA", UNMOVED))
        n = self._prepared(node, feed.groups)
        entry = NODES.get(node.type)
        if entry is None or entry.compile is None:
            return unknown(n, weight)
        if not belongs(n):
            return misplaced(n)
        return entry.compile(n, weight)

    def _prepared(self, node: Any, groups: Groups) -> Node:
        """A shader node with the values of its linked inputs."""
        n = Node(node, groups, self.graph, self.owner, self.around)
        for identifier, socket, feed, offset in self._needs(n, UNMOVED):
            self._evaluate(feed, offset)
            n.values[identifier] = self._result(feed, socket.type, offset)
        return n

    def displacement(self, socket: Any) -> Compiled | None:
        """Where what is linked to `socket` (an output node's Displacement) moves a vertex; None
        where that is nothing.
        """
        feed = self._value_feed(socket, ())
        if feed.node is None:
            return None
        self._evaluate(feed, UNMOVED)
        moved = self._result(feed, "VECTOR", UNMOVED)
        return Compiled(self.graph, [statement("Displace", weight=ONE, offset=moved)], Feature(0))

    def pass_value(self, outputs: Sequence[tuple[Any, Groups]], is_color: bool) -> Compiled:
        """The sum of what AOV outputs give, as a vector; each with the groups that it is in."""
        total = ORIGIN
        for node, groups in outputs:
            found = self.value(node.inputs["Color" if is_color else "Value"], groups)
            if not is_color:
                found = self.graph.one("Spread", value=found)
            total = found if total == ORIGIN else self.graph.one("AddVector", a=total, b=found)
        return Compiled(self.graph, [statement("Displace", weight=ONE, offset=total)], Feature(0))

    def _bent_normal(self, socket: Any, displaced: bool) -> Value | None:
        """The shading normal bent by a displacement taken as bump; None where there is no
        displacement.
        """
        feed = self._value_feed(socket, ())
        if feed.node is None:
            return None
        normal = self.graph.one("Geometry", what="NORMAL")
        heights = []
        steps = (UNMOVED, BumpOffset("DX", BUMP_WIDTH), BumpOffset("DY", BUMP_WIDTH))
        if displaced:
            steps = (
                BumpOffset("BEFORE"),
                BumpOffset("BEFORE_DX", BUMP_WIDTH),
                BumpOffset("BEFORE_DY", BUMP_WIDTH),
            )
        for offset in steps:
            self._evaluate(feed, offset)
            moved = self._result(feed, "VECTOR", offset)
            product = self.graph.add(
                "VectorMath", a=moved, b=normal, c=normal, scale=ONE, operation="DOT_PRODUCT"
            )
            heights.append(product["value"])
        if all(height == heights[0] for height in heights):
            return None
        if displaced:
            height, dx, dy = heights
            return self.graph.one(
                "DisplacementBump",
                width=BUMP_WIDTH,
                height=height,
                height_dx=dx,
                height_dy=dy,
                normal_in=normal,
            )
        fixed = {
            "strength": ONE,
            "distance": ONE,
            "width": BUMP_WIDTH,
            "normal_in": normal,
            "invert": False,
        }
        return self.graph.one(
            "Bump", height=heights[0], height_dx=heights[1], height_dy=heights[2], **fixed
        )

    # --- values ---

    def value(self, socket: Any, groups: Groups) -> Value:
        """What an input (of numbers, vectors or colours) gets, in its own kind."""
        feed = self._value_feed(socket, groups)
        self._evaluate(feed, UNMOVED)
        return self._result(feed, socket.type, UNMOVED)

    def _value_feed(self, socket: Any, groups: Groups) -> Feed:
        """What feeds an input: itself, with its own value, where links count as not there."""
        feed = self.around.trees.feed(socket, groups)
        if feed is None:
            self._report_loop(socket.node)
        if feed is None or (feed.node is not None and not self._gives(feed)):
            return Feed(None, socket, groups)
        return feed

    def _result(self, feed: Feed, to_type: str, offset: BumpOffset) -> Value:
        """The evaluated value of `feed` as it arrives in a socket of kind `to_type`."""
        if feed.node is None:
            holder = Node(feed.socket.node, feed.groups, self.graph, self.owner, self.around)
            value = ZERO if feed.empty else holder.own_value(feed.socket) or ZERO
        else:
            found = self._values[_key(feed.node, feed.groups, offset)].get(feed.socket.identifier)
            value = ZERO if found is None else found
        kind = "VALUE" if feed.empty else feed.socket.type
        for passed in (*reversed(feed.types), to_type):
            value = self.graph.convert(value, kind, passed)
            kind = passed
        return value

    def _evaluate(self, feed: Feed, offset: BumpOffset) -> None:
        """Makes sure that the outputs of what feeds are known."""
        if feed.node is None or _key(feed.node, feed.groups, offset) in self._values:
            return
        stack = [self._visit(feed, offset)]
        open_keys = {_key(feed.node, feed.groups, stack[0].offset)}
        while stack:
            self.around.watch.go_on()
            visit = stack[-1]
            if visit.waiting is not None:
                self._deliver(visit, visit.waiting)
                visit.waiting = None
            need = next(visit.needs, None)
            if need is None:
                stack.pop()
                key = _key(visit.node.node, visit.node.groups, visit.offset)
                open_keys.discard(key)
                self.graph.offset = visit.offset
                self._values[key] = self._outputs(visit.node)
                self.graph.offset = UNMOVED
                continue
            _, _, source, at = need
            if source.node is None:
                self._deliver(visit, need)
                continue
            at = _own_offset(source.node, at)
            key = _key(source.node, source.groups, at)
            if key in open_keys:
                self._report_loop(visit.node.node)
                continue
            visit.waiting = need
            if key not in self._values:
                stack.append(self._visit(source, at))
                open_keys.add(key)

    def _visit(self, feed: Feed, offset: BumpOffset) -> _Visit:
        n = Node(feed.node, feed.groups, self.graph, self.owner, self.around)
        own = _own_offset(feed.node, offset)
        return _Visit(n, own, self._needs(n, own))

    def _deliver(self, visit: _Visit, need: tuple[str, Any, Feed, BumpOffset]) -> None:
        identifier, socket, feed, offset = need
        visit.node.values[identifier] = self._result(feed, socket.type, offset)

    def _needs(self, n: Node, offset: BumpOffset) -> Iterator[tuple[str, Any, Feed, BumpOffset]]:
        """Linked inputs of a node: the names under which their values go, the sockets, what feeds
        them and where it is asked.
        """
        later = None
        for socket in n.node.inputs:
            if not socket.is_linked or not socket.enabled or socket.type in {"SHADER", "CUSTOM"}:
                continue
            feed = self._value_feed(socket, n.groups)
            if feed.node is None and feed.socket == socket:
                continue  # it is not linked after all
            if n.node.type == "BUMP" and socket.identifier == "Height":
                later = (socket, feed)
                continue
            yield socket.identifier, socket, feed, offset
        if later is not None:
            socket, feed = later
            width = bump_width(n)
            for suffix, at in (
                ("", UNMOVED),
                (".DX", BumpOffset("DX", width)),
                (".DY", BumpOffset("DY", width)),
            ):
                yield f"Height{suffix}", socket, feed, at

    def _gives(self, feed: Feed) -> bool:
        """False for nodes without any effect: links from them are ignored."""
        entry = NODES.get(feed.node.type)
        if feed.socket.type == "SHADER":
            said = "a shader is linked to a value; that link counts as not there"
            self.around.report.warn(f"{self.owner.name}, node '{label(feed.node)}': {said}")
            return False
        if entry is not None and entry.compile is not None and entry.kind != "shader":
            return True
        what = (
            entry.instead
            if entry is not None and entry.instead
            else "links from it count as not there"
        )
        name = feed.node.bl_label or feed.node.bl_idname
        self.around.report.warn(
            f"{self.owner.name}, node '{label(feed.node)}': {name} is not supported; {what}"
        )
        return False

    def _outputs(self, n: Node) -> dict[str, Value]:
        compile_node = NODES[n.node.type].compile
        assert compile_node is not None
        return compile_node(n)

    def _report_loop(self, node: Any) -> None:
        self.around.report.warn(
            f"{self.owner.name}, node '{label(node)}': its links run in a circle; one of them "
            "counts as not there"
        )


def _shines(feed: Feed) -> bool:
    """True for shaders that emit and do nothing else."""
    return (
        feed.node is None
        or feed.socket.type != "SHADER"
        or feed.node.type in {"EMISSION", "BACKGROUND"}
    )


def _own_offset(node: Any, offset: BumpOffset) -> BumpOffset:
    """The offset at which a node is computed. A Bump steps through its own height by itself, so in
    the height of another Bump it counts as the same everywhere.
    """
    return UNMOVED if node.type == "BUMP" else offset


def _key(node: Any, groups: Groups, offset: BumpOffset) -> Key:
    return (
        node.as_pointer(),
        tuple(group.as_pointer() for group in groups),
        _own_offset(node, offset),
    )


def _shader_key(feed: Feed) -> ShaderKey:
    pointer = (
        feed.socket.as_pointer()
        if feed.node is None or feed.socket.type != "SHADER"
        else feed.node.as_pointer()
    )
    return pointer, tuple(group.as_pointer() for group in feed.groups)
