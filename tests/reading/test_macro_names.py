"""Elements that URDF has are no calls of macros of their names, as old xacro has them."""

from pathlib import Path
from xml.etree import ElementTree

from tests.reading.carts import LIMIT, WHEELS, XACRO, quietly, urdf

OF_URDF = f"""
<material name="red"><color rgba="1 0 0 1"/><texture filename="red.png"/></material>
<link name="mast">
  <inertial><origin xyz="0 0 0"/><mass value="0.1"/>
    <inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/></inertial>
  <visual><geometry><mesh filename="mast.stl"/></geometry><material name="red"/></visual>
  <visual><geometry><capsule radius="0.01" length="0.1"/></geometry></visual>
  <visual><geometry><cylinder radius="0.01" length="0.1"/></geometry></visual>
  <collision><group/><geometry><sphere radius="0.01"/></geometry></collision>
  <collision><geometry><box size="0.01 0.01 0.01"/></geometry></collision>
  <contact/>
</link>
<joint name="mast_joint" type="revolute">
  <parent link="hull"/><child link="mast"/><axis xyz="0 1 0"/>{LIMIT}
  <dynamics damping="0"/><calibration rising="0"/><mimic joint="left_rear_joint"/>
  <safety_controller k_velocity="1"/>
</joint>
<transmission name="t"><type>simple</type><joint name="mast_joint"/>
  <actuator name="a"><hardwareInterface>effort</hardwareInterface>
    <mechanicalReduction>1</mechanicalReduction></actuator></transmission>
<sensor name="s"/>
<gazebo reference="mast"><plugin name="p" filename="p.so"/></gazebo>"""


def macro_like(element: ElementTree.Element) -> str:
    """A macro that an element would call, with its name, attributes and parts."""
    parts = [*element.attrib, *(f"*part{number}" for number in range(len(element)))]
    return f'<xacro:macro name="{element.tag}" params="{" ".join(parts)}"><wrong/></xacro:macro>'


def expanded(folder: Path, *macros: str) -> tuple[str, tuple[str, ...]]:
    """The text of a cart with macros, and its warnings."""
    path = folder / "cart.xacro"
    path.write_text(urdf(*macros, OF_URDF, WHEELS).replace('<robot name="cart">', XACRO))
    reading = quietly(path, mesh="leave_out")
    return reading.text, reading.warnings


def test_an_element_of_urdf_is_no_call_of_a_macro_of_its_name(tmp_path: Path) -> None:
    elements = {each.tag: each for each in ElementTree.fromstring(urdf(OF_URDF, WHEELS)).iter()}
    del elements["robot"]
    assert len(elements) == 35
    macros = [macro_like(each) for each in elements.values()]
    text, warnings = expanded(tmp_path)
    assert warnings == ()
    assert expanded(tmp_path, *macros) == (text, ())


def test_a_list_in_a_text_is_split_at_commas_semicolons_and_spaces(tmp_path: Path) -> None:
    path = tmp_path / "cart.xacro"
    names = """<xacro:property name="ends" value="${xacro.tokenize('a,b c;;d')}"/>
      <link name="${ends[0]}_${ends[1]}_${ends[2]}_${ends[3]}_${len(ends)}"/>"""
    path.write_text(urdf(names, WHEELS).replace('<robot name="cart">', XACRO))
    assert 'name="a_b_c_d_4"' in quietly(path).text


def test_messages_of_a_file_are_no_text(tmp_path: Path) -> None:
    path = tmp_path / "cart.xacro"
    calls = ("message('a')", "warning('a')", "error('a')", "print_location()")
    names = "".join(f"${{xacro.{call}}}" for call in calls)
    path.write_text(urdf(f'<link name="a{names}b"/>', WHEELS).replace('<robot name="cart">', XACRO))
    assert '<link name="ab"/>' in quietly(path).text


def test_another_element_is_a_call_of_a_macro_of_its_name(tmp_path: Path) -> None:
    element = ElementTree.fromstring('<ball radius="0.01"><a/></ball>')
    call = ElementTree.tostring(element, encoding="unicode")
    text, (warning,) = expanded(tmp_path, macro_like(element), call)
    assert "<wrong/>" in text
    assert warning.endswith("is taken as a call of the macro, which old xacro allowed, got <ball>")
