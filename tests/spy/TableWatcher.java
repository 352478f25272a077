// SPDX-License-Identifier: BSD-3-Clause
import java.awt.AWTEvent;
import java.awt.Component;
import java.awt.Container;
import java.awt.Rectangle;
import java.awt.Toolkit;
import java.awt.Window;
import java.awt.event.MouseEvent;
import java.awt.event.WindowEvent;
import java.util.Scanner;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JTable;
import javax.swing.SwingUtilities;
import javax.swing.event.TableModelEvent;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

/**
 * A plugin that lcm-spy finds on its class path and that tells, line by line, what a user sees:
 * "row CHANNEL TYPE MESSAGES UNDECODABLE" whenever the table has changed, "window TITLE" for each
 * window that opens. A channel's name on standard input has it open that channel as a user does,
 * with a double click.
 */
public final class TableWatcher implements SpyPlugin {
  private static final int CHANNEL = 0;
  private static final int TYPE = 1;
  private static final int MESSAGES = 2;
  private static final int UNDECODABLE = 7;

  private String channelToOpen = null;

  public TableWatcher() {
    Thread reader = new Thread(this::readChannels);
    reader.setDaemon(true);
    reader.start();
    Toolkit.getDefaultToolkit().addAWTEventListener(this::onWindow, AWTEvent.WINDOW_EVENT_MASK);
    SwingUtilities.invokeLater(() -> {
      for (Window window : Window.getWindows()) {
        JTable table = tableIn(window);
        if (table != null) table.getModel().addTableModelListener(event -> onChange(table, event));
      }
    });
  }

  @Override
  public boolean canHandle(long fingerprint) {
    return false;
  }

  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return null;
  }

  private static JTable tableIn(Component component) {
    if (component instanceof JTable) return (JTable) component;
    if (!(component instanceof Container)) return null;
    for (Component child : ((Container) component).getComponents()) {
      JTable table = tableIn(child);
      if (table != null) return table;
    }
    return null;
  }

  private static void tell(Object... words) {
    StringBuilder line = new StringBuilder();
    for (Object word : words) line.append(line.length() > 0 ? "\t" : "").append(word);
    System.out.println(line);
  }

  // Told from the thread that receives; the windows belong to Swing's thread.
  private void onChange(JTable table, TableModelEvent event) {
    SwingUtilities.invokeLater(() -> {
      try {
        for (int row = 0; row < table.getRowCount(); ++row) look(table, row);
      } catch (IndexOutOfBoundsException race) {
        // lcm-spy sorts its table in the thread that receives. The next change is looked at again.
      }
    });
  }

  private void look(JTable table, int row) {
    Object channel = table.getValueAt(row, CHANNEL);
    tell("row", channel, table.getValueAt(row, TYPE), table.getValueAt(row, MESSAGES),
         table.getValueAt(row, UNDECODABLE));
    if (channel.equals(channelToOpen)) doubleClick(table, row);
  }

  private void readChannels() {
    try (Scanner input = new Scanner(System.in)) {
      while (input.hasNextLine()) {
        String channel = input.nextLine();
        SwingUtilities.invokeLater(() -> channelToOpen = channel);
      }
    }
  }

  private static void doubleClick(JTable table, int row) {
    Rectangle cell = table.getCellRect(row, CHANNEL, false);
    table.dispatchEvent(new MouseEvent(table, MouseEvent.MOUSE_CLICKED,
                                       System.currentTimeMillis(), 0, cell.x + 1, cell.y + 1, 2,
                                       false, MouseEvent.BUTTON1));
  }

  private void onWindow(AWTEvent event) {
    if (event.getID() != WindowEvent.WINDOW_OPENED) return;
    if (!(event.getSource() instanceof JFrame)) return;
    JFrame frame = (JFrame) event.getSource();
    // Without a window manager every window opens at the same place.
    if (tableIn(frame) == null) frame.setLocation(300, 330);
    if (frame.getTitle().equals(channelToOpen)) channelToOpen = null;
    tell("window", frame.getTitle());
  }
}
